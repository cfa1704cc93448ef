"""scripts/long_functions counts a function's lines, whatever stands in it, and tells more long ones than there may be."""
import importlib.machinery
import importlib.util
import os
import sys

os.chdir(sys.argv[1])
loader = importlib.machinery.SourceFileLoader("long_functions", "scripts/long_functions")
sys.dont_write_bytecode = True
script = importlib.util.module_from_spec(importlib.util.spec_from_loader("long_functions", loader))
loader.exec_module(script)

BODY = '    call("}", \'}\', R"(})");  // }\n'
CASES = [  # source, the functions that are found
    ("int f(int x) {\n" + 9 * BODY + "}\n", [("f", 1, 11)]),
    ("namespace a {\nclass B : C<int()> {\n    int g() const {\n" + BODY + "    }\n};\n}\n", [("g", 3, 3)]),
    ("void A::h(int x,\n          int y)\n    : x_{x} {\n" + BODY + "}\n", [("A::h", 1, 5)]),
    ("void k()\n{\n    const auto inner = [&](int) {\n" + BODY + "    };\n}\n", [("k", 1, 6)]),
    ("const int kTable[] = {\n1,\n};\nstruct S {\n    int x = 0;\n};\n", []),
    ("#define M(x) \\\n    { \\\n        x; \\\n    }\nint f() { return 0; }\n", [("M", 1, 4), ("f", 5, 1)]),
]
failed = 0
for source, wanted in CASES:
    found = script.functions(source)
    if found != wanted:
        print(f"{source}\nexpected {wanted}, found {found}")
        failed = 1
if script.excess([101, 100, 61], {100: 0, 60: 3}) != ["1 functions above 100 lines, at most 0"]:
    print("a function of 101 lines is not told")
    failed = 1
sys.exit(failed)
