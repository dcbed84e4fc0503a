#include "compression_option.hpp"

#include "choice.hpp"

namespace sonopose::apps {

Option add_compression_option(CommandLine& app, mcap::Compression& compression) {
  using mcap::Compression;
  return add_choice<Compression>(
      app, "--compression", compression,
      {{"none", Compression::none}, {"lz4", Compression::lz4}, {"zstd", Compression::zstd}}, "Of the chunks");
}

}  // namespace sonopose::apps
