#!/bin/sh
# Wear of the scenes of Table 1 and of chapter 4: means of ensembles against values found
# with independent code on other surfaces of the same kind, three of each
. "$(dirname "$0")/../tap.sh"

# rough SQ CORR CROWN LOAD COUNT: contacts on 1 mm x 1 mm
rough() {
	roughgen -n 128 -L 1mm -q "$1" -l "$2" --crown "$3" -c "$5" | bemcontact -F "$4" -E 210GPa
}

# first NAME CONTACT% VOLUME PARTICLES: the first step of 20 surfaces; their means differ
# from those of three by what single surfaces scatter (10 to 20 %) over sqrt(3)
first() {
	debrisgen -Y 355MPa -u 0.3 --depth-step 7.8125um --summary s.tsv contact.nrrd >p.tsv 2>warning
	mean() { column "$1" s.tsv | awk '{ s += $1 } END { print s / NR }'; }
	near "$1: the contact is that of the thesis, %" "$(mean contact_fraction | awk '{ print 100 * $1 }')" "$2" \
		"$(awk -v v="$2" 'BEGIN { print 0.2 * v }')"
	near "$1: the volume is that of the thesis, 1e-12 m3" "$(mean volume | awk '{ print 1e12 * $1 }')" "$3" \
		"$(awk -v v="$3" 'BEGIN { print 0.12 * v }')"
	near "$1: the number of particles is that of the thesis" "$(mean particles)" "$4" "$(awk -v v="$4" 'BEGIN { print 0.2 * v + 0.5 }')"
}

rough 80um 100um 320um 50N 20 >contact.nrrd
first "Sq 80 um, correlation 100 um" 0.153 6.57 1
# One cluster carries the load: the particle hardly depends on the roughness.
near "a particle alone on its surface has the expected diameter, um" \
	"$(awk '/^[#r]/ { next } { n[$1]++; d[$1] = $7 } END { for (r in n) if (n[r] == 1) { s += d[r]; k++ }
		print 1e6 * s / k }' p.tsv)" 232.7 2
debrisgen -Y 355MPa -u 0.3 --depth-step 7.8125um --removal potential contact.nrrd >p.tsv 2>warning
near "a particle of the whole potential set has the expected diameter, 307 um in the thesis" \
	"$(awk '/^[#r]/ { next } { n[$1]++; d[$1] = $7 } END { for (r in n) if (n[r] == 1) { s += d[r]; k++ }
		print 1e6 * s / k }' p.tsv)" 308.4 2
rough 80um 50um 320um 50N 20 >contact.nrrd
first "Sq 80 um, correlation 50 um" 0.073 5.3 2.7
rough 8um 50um 32um 50N 20 >contact.nrrd
first "Sq 8 um, correlation 50 um" 0.433 4.13 4.3
rough 0.8um 50um 3.2um 50N 20 >contact.nrrd
first "Sq 0.8 um, correlation 50 um" 3.47 2.73 19.3
rough 0.8um 20um 3.2um 50N 20 >contact.nrrd
first "Sq 0.8 um, correlation 20 um" 1.85 1.7 74

# Ten steps.
rough 80um 100um 320um 50N 10 >contact.nrrd
debrisgen -Y 355MPa -u 0.3 --depth-step 7.8125um --steps 10 -E 210GPa --summary s.tsv contact.nrrd >p.tsv 2>warning
near "ten steps: mean volume, 1e-12 m3" \
	"$(column volume s.tsv | awk '{ s += 1e12 * $1 } END { print s / NR }')" 5.2 0.8
near "ten steps have as many particles as the thesis" "$(column particles s.tsv | awk '{ s += $1 } END { print s / NR * 10 }')" 38 12
ok "ten steps keep the relative roughness within 0.95 to 1.5" awk '!/^[#r]/ && $2 == 10 && ($13 < 0.95 || $13 > 1.5) { bad = 1 }
	END { exit bad }' s.tsv
rough 80um 100um 320um 100N 10 >contact.nrrd
debrisgen -Y 355MPa -u 0.3 --depth-step 7.8125um --steps 10 -E 210GPa --summary s.tsv contact.nrrd >p.tsv 2>warning
near "ten steps at 100 N: mean volume, 1e-12 m3" \
	"$(column volume s.tsv | awk '{ s += 1e12 * $1 } END { print s / NR }')" 12.7 2

# Chapter 4: 100 um x 100 um, 0.8 and 1.6 um of roughness together, cells 0.39 um high.
fragment() {
	roughgen -n 128 -L 100um -q 0.8um --pair 1.6um -l 10um -c 20 | bemcontact --pressure "$1" -E 210GPa |
		debrisgen -Y 355MPa -u 0.3 --depth-step 0.390625um --steps 6 -E 210GPa --summary s.tsv 2>warning >p.tsv
	column volume s.tsv | awk -v unit="$2" '{ s += $1 } END { print s / NR / unit }'
}
near "fragment at 21 MPa: mean volume, 1e-15 m3" "$(fragment 21MPa 1e-15)" 1.25 0.25
near "six steps of a fragment at 21 MPa have as many particles as the thesis" \
	"$(column particles s.tsv | awk '{ s += $1 } END { print 6 * s / NR }')" 27.7 12
near "fragment at 0.15 MPa: mean volume, 1e-18 m3" "$(fragment 0.15MPa 1e-18)" 1.3 0.3
done_testing
