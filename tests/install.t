#!/bin/sh
# make takes flags of the command line and does without libraries that are not needed;
# make install: programs, manuals, completion, headers and library work from where they lie
. "$(dirname "$0")/tap.sh"

programs=$(sed -n 's/^PROGRAMS = //p' "$top/Makefile")
# commands VARIABLE=VALUE... TARGET: what make would run, from the start
commands() {
	make -nB V=1 -C "$top" B="$work/build" BIN="$work/bin" "$@" 2>&1
}
cat >no-fftw <<EOF
#!/bin/sh
case " \$* " in *' -include fftw3.h '*) exit 1 ;; esac
exec ${CC:-cc} "\$@"
EOF
chmod +x no-fftw
is 'the archive has the sources of a library that is there' \
	"$(commands "$work/bin/records" | grep -c -e '-c -o .* lib/num/fft\.c$')" 1
is 'the archive goes without the sources of a library that is missing' \
	"$(commands CC="$work/no-fftw" "$work/bin/records" | grep -c -e '-c -o .* lib/num/fft\.c$')" 0
is 'flags of the command line join those of the project' "$(commands PKG_CONFIG=false CPPFLAGS=-DMINE CFLAGS=-O0 \
	"$work/build/lib/num/fft.o" | grep -c -e ' -Iinclude .* -DMINE -std=c11 .* -Wall .* -O0 ')" 1

is 'the prefix may be given in small letters, as other projects have it' \
	"$(commands prefix=/opt/w uninstall | grep -c '/opt/w/include/wearpipe')$(commands PREFIX=/opt/w uninstall | grep -c '/opt/w/include/wearpipe')" 11

root=$work/'a root'
if ! make -s -C "$top" install DESTDIR="$root" PREFIX=/usr >out 2>err; then
	fail 'make install' "$(tail -5 err)"
	done_testing
fi
pass 'make install, to a path with a blank'
usr=$root/usr
missing=
for p in $programs; do
	[ -x "$usr/bin/$p" ] || missing="$missing $p"
	[ -s "$usr/share/man/man1/$p.1" ] || missing="$missing $p.1"
	[ -s "$usr/share/bash-completion/completions/$p" ] || missing="$missing completion of $p"
done
is 'every program has its manual and completion' "$missing" ''
# complete WORD...: what bash offers for the last word of a command line.
complete_words() {
	bash -c '. "$0"/share/bash-completion/completions/wearpipe
		COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
		"_wearpipe_$1"; echo "${COMPREPLY[@]}"' "$usr" "$@"
}
if command -v bash >/dev/null; then
	is 'completion offers all choices of an option' "$(complete_words roughgen --acf '')" 'gauss exp'
	is 'completion offers the choices that begin as typed' "$(complete_words roughgen --acf g)" gauss
	is 'completion offers choices with a hyphen' "$(complete_words debrisgen --criterion v)" von-mises
	is 'completion works after an equals sign' "$(complete_words bemcontact --boundary = p)" periodic
	is 'completion offers the options' "$(complete_words duet --m)" '--method --material'
	is 'completion offers files otherwise' "$(cd "$top" && complete_words bpfilter READ)" README.md
else
	skip 'completion works in bash' 'no bash'
fi
for s in zsh fish; do
	file=$usr/share/zsh/site-functions/_wearpipe
	[ $s = zsh ] || file=$usr/share/fish/vendor_completions.d/wearpipe.fish
	if command -v $s >/dev/null; then
		ok "the completion of $s is well formed" $s -n "$file"
	else
		skip "the completion of $s is well formed" "no $s"
	fi
done

# Names: all that the library defines for others begins with wp_.
names() {
	nm "$@" | awk 'NF == 3 && $3 !~ /^wp_/ { print $3 }'
}
if [ -n "${ASAN_OPTIONS:-}" ]; then
	skip 'the symbols of the library are checked' 'built for the sanitizers'
elif command -v nm >/dev/null; then
	is 'the shared library exports only names that begin with wp_' \
		"$(names -D --defined-only "$usr/lib/libwearpipe.so.0")" ''
	is 'the archive exports only names that begin with wp_' \
		"$(names -g --defined-only "$usr/lib/libwearpipe.a")" ''
	is 'every function of the headers is in the library' "$(
		sed -n 's/^.*\(wp_[a-z_]*\)(.*/\1/p' "$usr"/include/wearpipe/*.h | sort -u >declared
		nm -D --defined-only "$usr/lib/libwearpipe.so.0" | awk '{ print $3 }' | sort >defined
		grep -h '^WP_API' -A 1 "$usr"/include/wearpipe/*.h | grep -o 'wp_[a-z_]*(' |
			tr -d '(' | sort -u | comm -23 - defined)" ''
fi

# The examples of the headers, each a whole program around the lines of its comment.
cd "$usr/include/wearpipe" || exit
for h in *.h; do
	{
		printf '#include <stdio.h>\n#include <math.h>\n#include <stdlib.h>\n#include <string.h>\n'
		echo "#include <wearpipe/$h>"
		printf 'int main(void)\n{\n'
		awk '/\*\// { exit } /^ \*\t/ { sub(/^ \*\t/, "\t"); print }' "$h"
		printf '\treturn 0;\n}\n'
	} >"$work/${h%.h}.example.c"
done
for h in *.h; do echo "#include <wearpipe/$h>"; done >"$work/all.c"
echo 'int main(void) { return 0; }' >>"$work/all.c"
cd "$work" || exit
cp all.c all.cc
ok 'all headers together compile as C11' ${CC:-cc} -std=c11 -Wall -Wextra -Wpedantic -Werror \
	-I"$usr/include" -fsyntax-only all.c
if command -v "${CXX:-c++}" >/dev/null; then
	ok 'all headers together compile as C++17' "${CXX:-c++}" -std=c++17 -Wall -Wextra -Wpedantic \
		-Werror -I"$usr/include" -fsyntax-only all.cc
else
	skip 'all headers together compile as C++17' 'no C++ compiler'
fi
for c in *.example.c; do
	name=${c%.example.c}
	if [ -n "${ASAN_OPTIONS:-}" ]; then
		skip "the example of $name.h compiles and runs" 'the library was built for the sanitizers'
	elif ${CC:-cc} -std=c11 -Wall -Wextra -Werror -I"$usr/include" "$c" \
		"$usr/lib/libwearpipe.so.0" -lm -o "$name" 2>err &&
		LD_LIBRARY_PATH=$usr/lib "./$name" >out 2>>err; then
		pass "the example of $name.h compiles and runs"
	else
		fail "the example of $name.h compiles and runs" "$(head -20 err)"
	fi
done

# The same through pkg-config, statically.
cp contact.example.c x.c
PKG_CONFIG_PATH=$usr/lib/pkgconfig:${PKG_CONFIG_PATH:-}
export PKG_CONFIG_PATH
if [ -n "${ASAN_OPTIONS:-}" ] || ! command -v pkg-config >/dev/null; then
	skip 'pkg-config finds the archive' 'not here'
else
	sed -e 's|@LIBDIR@|/a b/lib|' -e 's|@INCLUDEDIR@|/a b/include|' -e 's|@VERSION@|1|' \
		"$top/wearpipe.pc.in" >blank.pc
	is 'pkg-config quotes a path with a blank' "$(PKG_CONFIG_PATH=$work:$PKG_CONFIG_PATH pkg-config --cflags blank | sed 's/ *$//')" \
		'-I/a\ b/include'
	is 'pkg-config states the version' "$(pkg-config --modversion wearpipe)" \
		"$(sed -n 's/^VERSION = //p' "$top/Makefile")"
	flags=$(pkg-config --static --libs-only-l wearpipe | sed 's/-lwearpipe//')
	# shellcheck disable=SC2086 # flags are words
	if ${CC:-cc} -std=c11 -I"$usr/include" x.c "$usr/lib/libwearpipe.a" $flags -pthread \
		-o x 2>err && ./x >out; then
		is 'the archive gives the same results as the shared library' "$(cat out)" \
			"$(LD_LIBRARY_PATH=$usr/lib ./contact)"
	else
		fail 'the archive links with the libraries that pkg-config names' "$(head err)"
	fi
fi
# Installed again elsewhere; pkg-config finds the second library, not the first.
make -s -C "$top" install DESTDIR="$work/second" PREFIX='/opt/x&y' >out 2>err
is 'a second installation has its own folders' "$(head -n 1 "$work/second/opt/x&y/lib/pkgconfig/wearpipe.pc")" 'prefix=/opt/x&y'
if make -s -C "$top" install DESTDIR="$work/third/" PREFIX=relative >out 2>err; then
	fail 'a relative prefix is refused'
else
	like 'a relative prefix is refused' "$(cat err)" 'PREFIX=relative: want an absolute path'
fi
ok 'make uninstall succeeds' make -s -C "$top" uninstall DESTDIR="$root" PREFIX=/usr
is 'make uninstall leaves no file' "$(find "$root" -type f -o -type l)" ''
done_testing
