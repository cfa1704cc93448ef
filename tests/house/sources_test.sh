#!/bin/bash
# sources_test.sh SOURCE_DIR LIST -- every tracked C and C++ source is compiled by a target of this build (LIST, which tests/CMakeLists.txt
# writes), but for those that are built elsewhere. A file that moved out of all globs would otherwise be lost unseen.
cd "$1" || exit 1
tracked=$(git ls-files '*.cpp' '*.c') || exit 1
# Built by fuzzers, by the labs' and the templates' users, by tests that build plugins themselves, or only where a library is there;
# or not meant to compile.
elsewhere='^(tests/base/members_forgotten|tests/fuzz/|labs/|sdk/template/|plugins/importers/openmesh/|host/mpi/module/|tests/sdk/)'
lost=$(printf '%s\n' "$tracked" | grep -vE "$elsewhere" | LC_ALL=C sort | LC_ALL=C comm -23 - <(LC_ALL=C sort -u "$2"))
[ -z "$lost" ] || { printf 'in no target:\n%s\n' "$lost"; exit 1; }
