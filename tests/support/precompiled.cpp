/// \file
/// Holds the precompiled header of all tests: CMake needs a target with a source file.
