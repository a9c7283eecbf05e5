#!/bin/sh
# What make install lays down works: programs, manuals, completion, library and headers
. "$(dirname "$0")/tap.sh"

programs=$(sed -n 's/^PROGRAMS = //p' "$top/Makefile")
if ! make -s -C "$top" install DESTDIR="$work/root" PREFIX=/usr >out 2>err; then
	fail 'make install' "$(tail -5 err)"
	done_testing
fi
pass 'make install'
missing=
for p in $programs; do
	[ -x "root/usr/bin/$p" ] || missing="$missing $p"
	[ -s "root/usr/share/man/man1/$p.1" ] || missing="$missing $p.1"
	[ -s "root/usr/share/bash-completion/completions/$p" ] || missing="$missing completion of $p"
done
is 'every program has its manual and completion' "$missing" ''
if command -v bash >/dev/null; then
	is 'completion knows the choices of an option' "$(bash -c '
		. root/usr/share/bash-completion/completions/wearpipe
		COMP_WORDS=(roughgen --acf g) COMP_CWORD=2
		_wearpipe_roughgen; echo "${COMPREPLY[@]}"')" gauss
	is 'and the words of the options' "$(bash -c '
		. root/usr/share/bash-completion/completions/wearpipe
		COMP_WORDS=(bemcontact --pois) COMP_CWORD=1
		_wearpipe_bemcontact; echo "${COMPREPLY[@]}"')" --poisson
else
	skip 'completion knows the choices of an option' 'no bash'
	skip 'and the words of the options' 'no bash'
fi

# Headers: the interface, each of use alone, without what the modules share among themselves.
cd root/usr/include/wearpipe || exit
broken=
for h in */*.h; do
	echo "#include <$h>" | ${CC:-cc} -std=c11 -D_XOPEN_SOURCE=700 -I. -fsyntax-only -x c - || broken="$broken $h"
done 2>err
is 'every header compiles by itself' "$broken" ''
is 'those of contact and filter among them' "$(ls contact/solver.h signal/fir.h)" "$(printf 'contact/solver.h\nsignal/fir.h')"
is 'but none that is for its own modules only' "$(grep -l 'for lib/.* only' -r .)" ''
cd "$work" || exit

# The example of contact/solver.h, more or less, against the installed library.
cat >x.c <<'E2'
#include <contact/solver.h>
#include <stdio.h>

int main(void)
{
	static double h[64], p[64];
	struct contact_par par = { .nx = 8, .ny = 8, .dx = 1e-6, .dy = 1e-6, .estar = 1e11,
		.tolerance = 1e-8, .max_iterations = 1000 };
	struct contact *c = contact_new(&par);

	h[27] = 1e-9;
	if (!c || contact_solve(c, h, CONTACT_PRESSURE, 1e6, p, NULL) != CONTACT_OK)
		return 1;
	printf("%.3f\n", contact_result(c)->pressure / 1e6);
	contact_free(c);
	return 0;
}
E2
PKG_CONFIG_PATH=$work/root/usr/lib/pkgconfig:${PKG_CONFIG_PATH:-}
PKG_CONFIG_SYSROOT_DIR=$work/root
export PKG_CONFIG_PATH PKG_CONFIG_SYSROOT_DIR
if [ -n "${ASAN_OPTIONS:-}" ]; then
	skip 'a program is built against the installed library' 'it was built for the sanitizers'
elif flags=$(pkg-config --cflags --libs wearpipe) && ${CC:-cc} -std=c11 x.c $flags -lfftw3 -lgsl -lgslcblas \
	-lm -pthread -o x 2>err && ./x >out; then
	is 'a program is built against the installed library' "$(cat out)" 1.000
else
	fail 'a program is built against the installed library' "$(cat err)"
fi
ok 'make uninstall' make -s -C "$top" uninstall DESTDIR="$work/root" PREFIX=/usr
is 'leaves no file behind' "$(find root -type f -o -type l)" ''
done_testing
