# SPDX-License-Identifier: Apache-2.0
# Sourced by examples/run and tests/run: creates .venv in the checkout and installs the project into it.
#
# prepare EXTRAS   EXTRAS is "" or a list such as "[dev]". Takes no time if nothing has changed.

fail() {
    echo "$1" >&2
    exit 1
}

is_recent() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null
}

# Prints why a Python cannot be used; nothing if it does not start.
too_old() {
    version=$("$1" -c 'import sys; print("%d.%d.%d" % sys.version_info[:3])' 2>/dev/null) || return 0
    echo "Python $version at $(command -v "$1") is too old; "
}

find_python() {
    old=""
    for candidate in "${PYTHON:-}" python3 python3.14 python3.13 python3.12 python3.11 python3.10 python; do
        [ -n "$candidate" ] && command -v "$candidate" >/dev/null 2>&1 || continue
        if is_recent "$candidate"; then
            echo "$candidate"
            return
        fi
        old=${old:-$(too_old "$candidate")}
    done
    fail "${old}Python 3.10 or newer is needed: install it, or name it with PYTHON=/path/to/python3"
}

make_environment() {
    python=$(find_python)
    "$python" -m venv --clear .venv >/dev/null 2>&1 && return
    rm -rf .venv
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
        apt-get -qq update >/dev/null 2>&1 || true
        apt-get -qq install -y python3-venv >/dev/null 2>&1 || true
        "$python" -m venv .venv && return
    fi
    fail "the Python module venv is missing: as root, 'apt-get install python3-venv'"
}

# Prints the files on which the installed extension modules depend. An old module might give wrong results.
compiled_from() {
    cat pyproject.toml setup.py server/roaml/smc/opcodes.py server/roaml/smc/program.py
    for types in server/roaml/*/*.pxd; do
        cat "$types" "${types%.pxd}.py"
    done
}

# Installs Ruff alone, in the version of pyproject.toml: its results need nothing else of the project.
prepare_ruff() {
    wanted=$(grep -o 'ruff==[0-9.]*' pyproject.toml)
    [ "$(.venv/bin/ruff --version 2>/dev/null)" != "ruff ${wanted#ruff==}" ] || return 0
    is_recent .venv/bin/python || make_environment
    install "$wanted"
}

install() {
    .venv/bin/python -m pip install --quiet --disable-pip-version-check "$@" 2>.venv/pip.log ||
        { cat .venv/pip.log >&2; fail "pip could not install the project; is a package index configured and reachable?"; }
}

prepare() {
    wanted=$(compiled_from | cksum)
    case "$(cat .venv/prepared 2>/dev/null)" in
        "$wanted $1" | "$wanted [dev]") return ;;
    esac
    is_recent .venv/bin/python || make_environment
    # The tests use few modules of the packages in [dev]. Python compiles these when they are imported.
    case "$1" in "[dev]") install --no-compile --editable ".$1" ;; *) install --editable ".$1" ;; esac
    echo "$wanted $1" >.venv/prepared
}
