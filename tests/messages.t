#!/bin/sh
# What a user did wrong is said in terms of what was meant: the wrong kind of stream, units,
# empty and foreign tables, values that are possible but hardly meant
. "$(dirname "$0")/tap.sh"

roughgen --points 8 --length 10um --corr 3um >s.nrrd
printf '.snd\0\0\0\030\0\0\0\0\0\0\0\007\0\0\047\020\0\0\0\002' >s.au
printf 'RIFF\044\0\0\0WAVEfmt ' >s.wav
printf 't\ty\n0\t1\n1\t2\n' >t.tsv

# One stream for another: what it is, and what the program reads.
fails "a field for a table" 1 's.nrrd: this is a field (NRRD), want table: .*, from debrisgen' debrisstat s.nrrd
fails "a signal for a table" 1 's.au: this is a signal (AU), want table: t y' aopf --threshold 1 s.au
fails "a table for a field" 1 't.tsv: this is text, want fields: height' bemcontact --pressure 1MPa --young 210GPa t.tsv
fails "a signal for a field" 1 's.au: this is a signal (AU), want fields: height' \
	bemcontact --pressure 1MPa --young 210GPa s.au
fails "a table for a signal" 1 't.tsv: this is text, want signal' bpfilter t.tsv
fails "text tells what converts it to a signal" 1 't.tsv: this is text, want signal: .*: sigconvert converts it' duet t.tsv
fails "text tells what converts it to a field" 1 't.tsv: this is text, want fields: .*: surfimport converts heights' \
	bemcontact --pressure 1MPa --young 210GPa t.tsv
fails "a field for a signal" 1 's.nrrd: this is a field (NRRD), want signal' bpfilter s.nrrd
fails "WAV tells how to convert it" 1 's.wav: this is WAV audio, want signal: sigconvert converts it' bpfilter s.wav
fails "a surface without pressure tells who makes it" 1 "no field 'pressure', want .* from bemcontact" \
	debrisgen --yield 355MPa s.nrrd
bemcontact --pressure 1MPa --young 210GPa s.nrrd >contact.nrrd
fails "an empty file for a surrogate" 1 "/dev/null: empty, want a table with the column 'kind'" \
	debrisgen --yield 355MPa --surrogate /dev/null contact.nrrd
fails "an empty file for fields" 1 '/dev/null: empty, want fields: height' bemcontact --pressure 1MPa --young 210GPa /dev/null
fails "an empty file for a signal" 1 '/dev/null: empty, want a signal' duet /dev/null
fails "an empty table" 1 '/dev/null: empty, want' rwl --new --wear /dev/null --step-time 1h

# Tables of other programs.
printf 't;y\n0;1\n' >semicolon
fails "semicolons" 1 "no column 'y' among 't;y': 'sigconvert --output table' makes a table of it" aopf --threshold 1 semicolon
printf 't\ty\n0,5\t1\n' >comma
printf 't\ty\n2026-11-29\t1\n' >date
fails "dates" 1 "line 2: t: '2026-11-29' is not a number: 'sigconvert --output table' reads dates" aopf --threshold 1 date
fails "decimal commas" 1 "line 2: t: '0,5' is not a number: 'sigconvert --output table' reads decimal commas" aopf --threshold 1 comma
printf 'Time [h]\tFlow [L/min]\n0\t1\n' >named
fails "the columns there are are named" 1 "no column 'y' among 'Time \[h\]' 'Flow \[L/min\]': 'sigconvert --output table' makes" aopf --threshold 1 named

# Units.
fails "a unit with wrong capitals" 2 'young 210Gpa: did you mean GPa?' bemcontact --young 210Gpa --pressure 1MPa s.nrrd
fails "one of two units with wrong capitals" 2 'young 210GPa,70gpa: did you mean GPa?' bemcontact --young 210GPa,70gpa --pressure 1MPa s.nrrd
fails "a unit of another quantity" 2 "'210um' has the wrong unit" bemcontact --young 210um --pressure 1MPa s.nrrd
fails "a blank before the unit" 2 "'mm' is taken for a file, which is not there; a unit" roughgen --length 1 mm
is "a file of that name is read as a file" "$(cp s.nrrd mm; roughgen --sq 1um mm | records - | grep -c height)" 1

fails "an option with two letters exchanged" 2 '\--lenght: no such option: did you mean --length?' roughgen --lenght 1mm
fails "an option with a letter too few" 2 '\--pressre=1MPa: no such option: did you mean --pressure?' bemcontact --pressre=1MPa s.nrrd
fails "an option with two letters too many" 2 '\--pressuresd: no such option: did you mean --pressure?' bemcontact --pressuresd 1MPa s.nrrd
fails "an option with two letters too few" 2 '\--presre: no such option: did you mean --pressure?' bemcontact --presre 1MPa s.nrrd
fails "an option with two wrong letters" 2 '\--prassare: no such option: did you mean --pressure?' bemcontact --prassare 1MPa s.nrrd
fails "an option with three wrong letters" 2 '\--prassari: no such option; see bemcontact --help' bemcontact --prassari 1MPa s.nrrd
fails "an option like no other" 2 '\--zigzag: no such option; see roughgen --help' roughgen --zigzag
fails "a decimal comma" 2 '\--sq 0,8um: write decimals with a point' roughgen --sq 0,8um
fails "a decimal comma in a single number" 2 '\--estar 1,5GPa: write decimals with a point' bemcontact --pressure 1MPa --estar 1,5GPa s.nrrd
fails "a comma for a cross" 2 "'0.5um,0.5um' has the wrong unit, want D" surfimport --pixel 0.5um,0.5um --height-unit 1um s.nrrd
fails "a negative load" 2 '\--load -50N: want at least 0' bemcontact --load -50N --young 210GPa s.nrrd
fails "a table for a surface to be measured" 1 't.tsv: this is text, want fields: height' roughgen --measure t.tsv

# Possible, but hardly meant: said, and done.
doubted() {
	is "$1 gives a warning" "$("$3" 2>&1 >/dev/null | grep -c -e "$2")" 1
}
metre() { roughgen --points 8 --length 1; }
white() { roughgen --points 8 --length 10um --corr 1um; }
soft() { bemcontact --young 210 --pressure 1Pa s.nrrd; }
weak() { bemcontact --young 210GPa --pressure 1kPa s.nrrd | debrisgen --yield 355; }
plain() { bemcontact --young 210GPa --pressure 1MPa s.nrrd; }
doubted "a surface of a metre" '--length 1 m: .* is 1mm meant?' metre
doubted "waves shorter than the spacing" '--corr 1e-06 m is below the spacing of 1.25e-06 m' white
doubted "a body softer than jelly" '--young 210 Pa .* is 210GPa meant?' soft
doubted "a yield stress of jelly" '--yield 355 Pa .* is 355MPa meant?' weak
light() { bemcontact --young 210GPa --pressure 21 s.nrrd; }
crushed() { bemcontact --young 210GPa --pressure 50GPa s.nrrd; }
steep() { roughgen --points 8 --length 10um --corr 3um --sq 1; }
hard() { bemcontact --young 210GPa --pressure 1MPa s.nrrd | debrisgen --yield 355GPa; }
sticky() { bemcontact --young 210GPa --pressure 1MPa s.nrrd | debrisgen --yield 355MPa --friction 30; }
coarse() { sensorsim --uniform 50um:150um --number 2 --duration 1s --rate 10Hz; }
loud() { sensorsim --uniform 50um:150um --number 2 --duration 1s --noise 5; }
flood() { printf 't\tleakage\n0\t2e-5\n1\t3e-5\n' | rwl --threshold-leakage 2.8; }
abyss() { printf 'diameter\n1e-5\n' | abrade --gap 1 --hardness 2GPa --friction 0.1; }
doubted "a rate too low for the pulses" '--rate 10 Hz: a pulse of 0.01 s has fewer than four samples' coarse
doubted "noise of some volts" '--noise 5 V: .* is 5mV meant?' loud
doubted "a leakage of cubic metres" '--threshold-leakage 2.8 m3/s: is 2.8L/min meant?' flood
doubted "a gap of a metre" '--gap 1 m: is 1um meant?' abyss
doubted "a pressure of some pascals" '--pressure 21 Pa is very low: is 21MPa meant?' light
beyond='where the bodies touch, .* GPa, is above a tenth of the contact modulus of 115 GPa'
doubted "a pressure beyond elasticity" "$beyond: .* --hardness" crushed
# 0.4 E* times the rms slope, of 0.6 and 0.06
rough() { roughgen --points 64 --length 1mm --corr 50um --crown auto --sq "$1" 2>/dev/null |
	bemcontact --young 210GPa --pressure 10MPa; }
jagged() { rough 20um; }
doubted "slopes beyond elasticity" "$beyond" jagged
is "small slopes give no warning" "$(rough 2um 2>&1 >/dev/null)" ""
doubted "heights of a metre" 'heights of 1 m exceed the correlation length of 3e-06 m' steep
doubted "a yield stress beyond that of any solid" '--yield 3.55e+11 Pa is stronger than any solid' hard
doubted "a friction coefficient in per cent without the sign" '--friction 30: is 30% meant?' sticky
ok "a friction coefficient in per cent is accepted" sh -c "bemcontact --young 210GPa --pressure 1MPa s.nrrd | debrisgen --yield 355MPa --friction 30%"
is "ordinary values give no warning" "$(plain 2>&1 >/dev/null)" ""
done_testing
