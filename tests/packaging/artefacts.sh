#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds and tries every artefact of a release that this machine can build, and lists what it did not run. It needs
# Python 3.10 or newer, a C compiler, and the package registries; nothing is uploaded and no account is needed.
set -eu
cd "$(dirname "$0")/../.."
. tests/environment.sh
root=$(pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python=$(find_python)
missed=""

say() {
    echo "== $*"
}

# fresh NAME   creates an empty environment; its Python is $work/NAME/bin/python.
fresh() {
    "$python" -m venv "$work/$1"
}

pip() {
    environment=$1
    shift
    "$work/$environment/bin/python" -m pip --disable-pip-version-check --quiet "$@"
}

say "versions"
"$python" docs/packaging/release_version.py

say "source distribution"
fresh tools
pip tools install build==1.6.1 check-jsonschema==0.39.0 cibuildwheel==4.3.3 cmake==4.4.4
mkdir "$work/source"
git archive HEAD | tar -x -C "$work/source"
"$work/tools/bin/python" -m build --sdist --outdir "$work/dist" "$work/source" >"$work/build.log"

say "wheel from it, with the compiled kernel, in an empty environment"
pip tools wheel --no-deps --wheel-dir "$work/dist" "$work"/dist/*.tar.gz
fresh compiled
pip compiled install "$work"/dist/*linux*.whl
"$work/compiled/bin/python" tests/packaging/smoke.py --compiled
"$python" tests/packaging/wheel_content.py "$work"/dist/*linux*.whl

say "wheel for every platform; its kernel is compiled afterwards"
AS2FM_PURE_PYTHON=1 pip tools wheel --no-deps --wheel-dir "$work/dist" "$work"/dist/*.tar.gz
fresh any
pip any install "$work"/dist/*-none-any.whl
"$work/any/bin/python" tests/packaging/smoke.py --plain
"$work/any/bin/python" -m as2fm_lsp.cli.build_kernel
"$work/any/bin/python" tests/packaging/smoke.py --compiled
"$python" tests/packaging/wheel_content.py "$work"/dist/*-none-any.whl

say "GitHub: workflows, action, templates"
schema="$work/tools/bin/check-jsonschema"
"$schema" --builtin-schema vendor.github-workflows .github/workflows/*.yml docs/ci/github.yml
"$schema" --builtin-schema vendor.github-actions action.yml
"$schema" --builtin-schema vendor.gitlab-ci docs/ci/gitlab.yml

say "wheels that the release workflow builds on Linux"
"$work/tools/bin/cibuildwheel" --platform linux --archs x86_64 --print-build-identifiers "$root"

say "the steps of the action"
mkdir "$work/runner"
ln -s "$work/compiled" "$work/runner/as2fm"
RUNNER_TEMP=$work/runner "$work/tools/bin/python" tests/packaging/action_steps.py action.yml examples/delivery_robot

say "CMake function ament_as2fm, with stubs of ament_cmake"
mkdir "$work/package"
cp tests/packaging/ament_stub/CMakeLists.txt "$work/package"
cp -r examples/delivery_robot "$work/package/models"
PATH="$work/compiled/bin:$work/tools/bin:$PATH" sh -c "
    cmake -S '$work/package' -B '$work/package_build' -DAMENT_CMAKE_AS2FM='$root/docs/packaging/ament_cmake_as2fm' \
        >'$work/cmake.log' &&
    ctest --test-dir '$work/package_build' --output-on-failure"
test -s "$work/package_build/test_results/my_robot/as2fm.xunit.xml"

say "VS Code extension for Linux, installed without network"
if command -v npm >/dev/null 2>&1; then
    (cd "$work/source/vscode-extension" && npm ci --silent && PYTHON="$work/tools/bin/python" npm run --silent package -- \
        --target linux-x64) >"$work/vsix.log"
    without_network=""
    unshare -n true 2>/dev/null && without_network="unshare -n"
    $without_network "$python" tests/packaging/vsix_offline.py "$work/source/vscode-extension/as2fm-linux-x64.vsix"
else
    missed="$missed; the VS Code extension (there is no npm)"
fi

say "the steps of the Dockerfile that need no Docker: the copied files are enough to build and to work"
mkdir "$work/context"
sed -n 's/^COPY \([^-].*\) \/source\/.*$/\1/p' Dockerfile | tr ' ' '\n' | while read -r copied; do
    cp -r "$work/source/$copied" "$work/context"
done
fresh container
pip container install "$work/context"
"$work/container/bin/as2fm-lsp" --check "$work/source/examples/delivery_robot"

say "man page and completion of shells"
pip compiled install shtab==1.13.0 argparse-manpage==4.8
mkdir "$work/shell"
"$work/compiled/bin/python" docs/packaging/shell_files.py "$work/shell"
bash -n "$work/shell/as2fm-lsp.bash"
grep -q -e --exhaustive "$work/shell/as2fm-lsp.bash"
grep -q TH "$work/shell/as2fm-lsp.1"

say "not run here: wheels for musl, arm64, macOS and Windows, signatures, uploads, Docker, conda, colcon, rosdep;"
echo "   the extension is also tried in a workbench by tests/vscode.sh$missed"
