#!/bin/sh
# The Debian packages build from the committed tree, pass lintian and hold what they should
. "$(dirname "$0")/../tap.sh"

formula=$top/packaging/wearpipe.rb
if command -v ruby >/dev/null; then
	ok 'the Homebrew formula is Ruby' ruby -c "$formula"
else
	skip 'the Homebrew formula is Ruby' 'no ruby'
fi
is 'the formula names files that exist' "$(sed -n '/def install/,/^  end/p' "$formula" | grep -o '"[^"]*"' | tr -d '"' |
	grep -v -e '^make$' -e '^all$' -e '^build/' | while read -r f; do
		set -- "$top"/$f
		[ -e "$1" ] || echo "$f"
	done)" ''
for p in fftw gsl gnuplot libsndfile; do
	ok "scripts/deps and the formula need $p" \
		sh -c "grep -q 'depends_on \"$p\"' '$formula' && grep -q ' $p\$' '$top/scripts/deps'"
done
if ! command -v dh >/dev/null || ! command -v lintian >/dev/null || ! git -C "$top" rev-parse 2>/dev/null; then
	skip 'the packages build and lintian finds nothing' 'no debhelper, lintian or git tree'
	done_testing
fi
DEB_BUILD_OPTIONS='nocheck parallel=2'
export DEB_BUILD_OPTIONS
ok 'the packages build and lintian finds nothing' "$top/packaging/build-deb"
holds() {
	dpkg-deb -c "$top"/build/deb/"$1"_*.deb | grep -q "$2" && echo yes
}
is 'programs are in wearpipe' "$(holds wearpipe usr/bin/roughgen)" yes
is 'the packages contain the pages' "$(holds wearpipe usr/share/man/man1/roughgen.1.gz)" yes
is 'the shared library has a package of its own' "$(holds libwearpipe0 libwearpipe.so.0)" yes
is 'headers are in the development package' "$(holds libwearpipe-dev usr/include/wearpipe/contact.h)" yes
done_testing
