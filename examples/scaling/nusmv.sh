#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds NuSMV 2.5.4 (LGPL 2.1) from the source package of pynusmv on PyPI: sh nusmv.sh DIR makes DIR/NuSMV.
# Needs a C compiler, make, flex, bison, and the headers of readline and expat.
set -eu
[ $# = 1 ] || { echo "usage: sh nusmv.sh DIR" >&2; exit 2; }
for tool in gcc make flex bison; do
    command -v "$tool" >/dev/null 2>&1 || { echo "$tool is missing" >&2; exit 1; }
done
mkdir -p "$1"
cd "$1"
target=$PWD
python3 -m pip download --quiet --no-deps --no-binary :all: pynusmv==1.0rc8 ||
    { echo "the source package of pynusmv cannot be had from the package index" >&2; exit 1; }
tar xzf pynusmv-1.0rc8.tar.gz
tar xzf pynusmv-1.0rc8/dependencies/NuSMV/NuSMV-2.5.4.tar.gz
# The sources of 2011 need an older C, and a type that today's <sys/wait.h> does not define.
printf '#!/bin/sh\nexec gcc -std=gnu89 -fcommon -w "$@"\n' >cc89
chmod +x cc89
cd NuSMV-2.5.4
sed -i 's/union wait status/int status/' cudd-2.4.1.1/util/pipefork.c
make -C cudd-2.4.1.1 -f Makefile_64bit CC="$target/cc89" >"$target/build.log" 2>&1 ||
    { tail -n 20 "$target/build.log" >&2; exit 1; }
cd nusmv
{ ./configure --disable-minisat --disable-zchaff CC="$target/cc89" CFLAGS=-O2 && make; } >>"$target/build.log" 2>&1 ||
    { tail -n 20 "$target/build.log" >&2; exit 1; }
cp NuSMV "$target/NuSMV"
echo "$target/NuSMV"
