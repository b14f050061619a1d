// A configuration is read or refused; what is read makes a tick, or is refused with a reason.
#include <exception>
#include <stdexcept>

#include "drivers/files/temporary_folder.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tools/checkout/checkout.hpp"

namespace {

/// Holds the configuration, and links for the paths in it, which are those of the shipped ones.
class Folder {
 public:
  Folder() {
    const std::filesystem::path config = patella::checkout::source() / "firmware_app/config";
    for (const char* name : {"models", "can", "references"}) {
      std::filesystem::create_directory_symlink(config / name, folder_ / name);
    }
  }
  const std::filesystem::path& path() const { return folder_.path(); }

 private:
  patella::files::TemporaryFolder folder_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace patella;
  static const Folder folder;
  const std::filesystem::path path = folder.path() / "fuzz.toml";
  if (std::FILE* file = std::fopen(path.c_str(), "wb"); file != nullptr) {
    const std::string text = fuzz::expanded(fuzz::text(data, size));
    std::fwrite(text.data(), 1, text.size(), file);
    std::fclose(file);
  }
  try {
    app::CommandLine line;
    line.config = path;
    const app::RunConfig config = app::loadRunConfig(line);
    app::makeTick(config);
    app::makeDecoder(config);
  } catch (const std::runtime_error&) {
    // refused with file and line
  } catch (const std::invalid_argument&) {
    // refused by a constructor
  }
  return 0;
}
