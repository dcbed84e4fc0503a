// Owner of the precompiled headers of the modules on the path of a sample.
