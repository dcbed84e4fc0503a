/// \file
/// Nothing but what is precompiled for all tests: CMake precompiles for targets that compile something.
