# turned.pl heights HOW NX NY <heights >turned: raw heights of nx by ny, mirrored in y, exchanged in x
#	and y, or moved periodically
# turned.pl particles HOW LX LY FILE TURNED: the largest relative difference between the particles of
#	one table, turned, and those of the other; the number of particles comes first
use strict;
use warnings;
my ($task, $how, $x, $y, @files) = @ARGV;
my %move = (x => 27, y => 13);

if ($task eq 'heights') {
	local $/;
	binmode STDIN;
	binmode STDOUT;
	my @h = unpack 'd<*', <STDIN>;
	my @turned;
	for my $iy (0 .. $y - 1) {
		for my $ix (0 .. $x - 1) {
			my $at = $how eq 'mirrored' ? ($y - 1 - $iy) * $x + $ix
				: $how eq 'exchanged' ? $ix * $y + $iy
				: ($iy + $move{y}) % $y * $x + ($ix + $move{x}) % $x;
			$turned[$at] = $h[$iy * $x + $ix];
		}
	}
	print pack 'd<*', @turned;
	exit;
}

sub table {
	my ($name) = @_;
	my @rows;
	my @names;
	open my $in, '<', $name or die "$name: $!";
	while (<$in>) {
		next if /^#/;
		chomp;
		my @row = split /\t/;
		if (!@names) { @names = @row; next; }
		my %row;
		@row{@names} = @row;
		push @rows, \%row;
	}
	return @rows;
}

# A direction in the plane and its opposite have the same doubled angle.
sub axis {
	my ($r) = @_;
	return (cos(2 * $r->{azimuth}), sin(2 * $r->{azimuth}));
}

my @one = table $files[0];
my @other = table $files[1];
my $most = 0;
my $differ = sub {
	my ($d) = map { abs } @_;
	$most = $d if !($d <= $most); # nan too
};
@one == @other or die scalar(@one) . ' and ' . scalar(@other) . " particles\n";
for my $k (0 .. $#one) {
	my ($p, $q) = ($one[$k], $other[$k]);
	my %place = (x => $p->{x}, y => $p->{y});
	my %side = (x => $x, y => $y);
	my $cell = $x / 64;
	$place{y} = $y - $p->{y} if $how eq 'mirrored';
	@place{qw(x y)} = @place{qw(y x)}, @side{qw(x y)} = @side{qw(y x)} if $how eq 'exchanged';
	if ($how eq 'moved') { $place{$_} += $move{$_} * $cell for qw(x y); }
	for my $c (qw(x y)) {
		my $d = ($place{$c} - $q->{$c}) / $side{$c};
		$differ->($d - sprintf '%.0f', $d);
	}
	$differ->($p->{$_} / $q->{$_} - 1) for qw(columns volume diameter length width aspect solidity area z);
	$differ->($p->{elongation} - $q->{elongation});
	if ($p->{azimuth} eq 'nan' || $q->{azimuth} eq 'nan') {
		$differ->($p->{azimuth} eq $q->{azimuth} ? 0 : 1);
		next;
	}
	my @m = axis $p;
	my @n = axis $q;
	$m[1] = -$m[1] if $how eq 'mirrored';
	$m[0] = -$m[0] if $how eq 'exchanged';
	$differ->(cos($p->{dip}) * ($m[$_] - $n[$_])) for 0, 1; # of no weight where the axis is upright
	$differ->($p->{dip} - $q->{dip});
}
printf "%d %g\n", scalar(@one), $most;
