#!/usr/bin/env bash
# What `make install` installs, put below a folder as it is to stand below PREFIX. Manual pages, completion
# and schema are made here, of what the program says.
# Usage: stage.sh STANCE BUILD FOLDER PREFIX PYTHON
set -eu
stance=$1 build=$2 folder=$3 prefix=$4 python=$5 here=$(dirname "$0")
# What a program needs beside the archives of the engine and of control design.
libs="-llapacke -lslicot -llapack -lblas -lsundials_arkode -lsundials_nvecserial -lm"
put() { # mode, where, files ...
    local mode=$1 where=$2
    shift 2
    install -d "$folder/$where" && install -m "$mode" "$@" "$folder/$where"
}
rm -rf "$folder"
put 755 bin "$stance"
put 644 include/stance/engine engine/stance.h engine/tree_numbers.h engine/mechanism.h engine/tree.h
put 644 include/stance/engine/control engine/control/design.h
put 644 include/stance runner/objects/law/*.h
put 644 lib "$build/libstance.a" "$build/libstance_control.a"
put 644 share/doc/stance LICENSE README.md CHANGELOG.md CITATION.cff
for f in $(cd scenarios && find . -name '*.yaml' -o -name '*.sh' -o -name '*.c'); do
    put 644 "share/stance/scenarios/$(dirname "$f")" "scenarios/$f"
done
# Where this Python looks below PREFIX, if it does; else where PYTHONPATH would say.
packages=$("$python" -I -c 'import site, sys; root = sys.argv[1] + "/lib/python"
print(*(p[len(root) - 10:] for p in site.getsitepackages() if p.startswith(root)), sep="\n")' "$prefix" 2>/dev/null | head -n 1)
put 644 "${packages:-lib/python3/dist-packages}/stance" analysis/python/stance/*.py

mkdir -p "$folder"/lib/pkgconfig "$folder"/share/{man/man{1,5},bash-completion/completions,zsh/site-functions,fish/vendor_completions.d}
cat >"$folder/lib/pkgconfig/stance.pc" <<END
prefix=$prefix
includedir=\${prefix}/include/stance
libdir=\${prefix}/lib

Name: stance
Description: Planar robots with exact contact, simulated in batches, and control design
Version: $("$stance" --version | awk 'NR == 1 {print $2}')
Cflags: -I\${includedir}
Libs: -L\${libdir} -lstance_control -lstance $libs
END
"$stance" describe --schema >"$folder/share/stance/scenario.schema.json"
bash "$here/manual.sh" "$stance" "$folder/share/man"
mv "$folder"/share/man/*.1 "$folder/share/man/man1" && mv "$folder"/share/man/*.5 "$folder/share/man/man5"
bash "$here/completion.sh" "$stance" bash >"$folder/share/bash-completion/completions/stance"
bash "$here/completion.sh" "$stance" zsh >"$folder/share/zsh/site-functions/_stance"
bash "$here/completion.sh" "$stance" fish >"$folder/share/fish/vendor_completions.d/stance.fish"
