// Nothing but the precompiled headers of CMakeLists.txt.
