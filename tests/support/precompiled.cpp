// Carries the precompiled header of the tests (tests/CMakeLists.txt); has no tests of its own.
