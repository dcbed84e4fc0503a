/// \file
/// Exists only to hold the precompiled header of all tests: CMake needs a target with a source file.
