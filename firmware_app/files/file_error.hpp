// The one exception of everything that reads or writes files.
#pragma once

#include <stdexcept>

namespace patella::app {

/// what() names the file, where possible the line and the key or column, the value found and what was
/// expected in its place.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace patella::app
