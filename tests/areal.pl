# areal.pl - areal parameters of headerless heights on standard input, from their definitions
# in roughgen(1): Sa Sq Ssk Sku Sp Sv Sz, five Sdq, Sdr, correlation lengths along x and y
#
# usage: areal.pl NX NY DX DY
use strict;
use warnings;

my ($nx, $ny, $dx, $dy) = @ARGV;
read STDIN, my $bytes, 8 * $nx * $ny;
my @h = unpack "d<*", $bytes;
my $n = $nx * $ny;
my $mean = 0;
$mean += $_ / $n for @h;
my ($sa, $sq, $m3, $m4, $sp, $sv) = (0) x 6;
for (@h) {
	$_ -= $mean;
	$sa += abs($_) / $n; $sq += $_ ** 2 / $n; $m3 += $_ ** 3 / $n; $m4 += $_ ** 4 / $n;
	$sp = $_ if $_ > $sp; $sv = -$_ if -$_ > $sv;
}
$sq = sqrt $sq;
sub z { my ($x, $y) = @_; $x >= 0 && $x < $nx && $y >= 0 && $y < $ny ? $h[$y * $nx + $x] : "nan" + 0 }
# Mean of a formula over the places where all its samples exist.
sub mean {
	my ($f, $sum, $count) = (shift, 0, 0);
	for my $y (0 .. $ny - 1) { for my $x (0 .. $nx - 1) {
		my $v = $f->($x, $y);
		if ($v == $v) { $sum += $v; $count++ }
	} }
	$sum / $count;
}
sub fx { (z($_[0] + 1, $_[1]) - z(@_)) / $dx }
sub fy { (z($_[0], $_[1] + 1) - z(@_)) / $dy }
sub difference { # antisymmetric about x, y, along u, v
	my ($x, $y, $u, $v, $d, @c) = @_;
	my $sum = 0;
	$sum += $c[$_ - 1] * (z($x + $_ * $u, $y + $_ * $v) - z($x - $_ * $u, $y - $_ * $v)) for 1 .. @c;
	$sum / $d;
}
sub formula {
	my @c = @_;
	sqrt mean(sub { difference(@_, 1, 0, $dx, @c) ** 2 + difference(@_, 0, 1, $dy, @c) ** 2 });
}
sub area { # of the triangles that three of four corners of a cell make, over its half
	my ($ux, $uy) = @_;
	sqrt(1 + $ux ** 2 + $uy ** 2) / 4;
}
sub fall { # lag along U, V where the correlation is 1/e
	my ($u, $v, $d) = @_;
	my $before = 1;
	for (my $j = 1; ; $j++) {
		my $r = mean(sub { z(@_) * z($_[0] + $j * $u, $_[1] + $j * $v) }) / $sq ** 2;
		return $d * ($j - 1 + ($before - exp -1) / ($before - $r)) if $r < exp -1;
		$before = $r;
	}
}
printf "%.17g\n", $_ for $sa, $sq, $m3 / $sq ** 3, $m4 / $sq ** 4, $sp, $sv, $sp + $sv,
	sqrt(mean(sub { fx(@_) ** 2 }) + mean(sub { fy(@_) ** 2 })),
	sqrt mean(sub { fx(@_) ** 2 + fy(@_) ** 2 }),
	sqrt mean(sub { my ($x, $y) = @_;
		((fx(@_) + fx($x, $y + 1)) / 2) ** 2 + ((fy(@_) + fy($x + 1, $y)) / 2) ** 2 }),
	formula(1 / 2), formula(45 / 60, -9 / 60, 1 / 60),
	mean(sub { my ($x, $y) = @_; my @v = (fy(@_), fy($x + 1, $y));
		area(fx(@_), $v[0]) + area(fx(@_), $v[1]) +
			area(fx($x, $y + 1), $v[0]) + area(fx($x, $y + 1), $v[1]) }) - 1,
	fall(1, 0, $dx), fall(0, 1, $dy);
