#include "tools/recordings/mat_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include <H5Epublic.h>
#include <fmt/format.h>
#include <matio.h>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::diagnose {
namespace {

using app::FileError;

constexpr std::size_t kMostVariablesListed = 20;

struct CloseFile {
  void operator()(mat_t* file) const noexcept { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const noexcept { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

std::string sizeOf(const matvar_t& variable) {
  if (variable.class_type == MAT_C_STRUCT) {
    return "struct";
  }
  if (variable.class_type == MAT_C_CELL) {
    return "cell";
  }
  if (variable.class_type == MAT_C_CHAR) {
    return "char";
  }
  std::string size;
  for (int i = 0; i < variable.rank; ++i) {
    size += (i == 0 ? "" : "x") + std::to_string(variable.dims[i]);
  }
  return size;
}

std::size_t countOf(const matvar_t& variable) {
  std::size_t count = 1;
  for (int i = 0; i < variable.rank; ++i) {
    count *= variable.dims[i];
  }
  return count;
}

/// Names with sizes, of which the first are told.
class Listing {
 public:
  void add(const std::string& name, const matvar_t* variable) {
    names_.push_back(name);
    if (names_.size() <= kMostVariablesListed) {
      text_ += (text_.empty() ? "" : ", ") + name +
               (variable == nullptr ? std::string(" (empty)") : " (" + sizeOf(*variable) + ")");
    }
  }
  const std::vector<std::string>& names() const noexcept { return names_; }
  std::string text() const {
    return text_.empty() ? "nothing"
           : names_.size() <= kMostVariablesListed
               ? text_
               : text_ + " and " + std::to_string(names_.size() - kMostVariablesListed) + " more";
  }

 private:
  std::vector<std::string> names_;
  std::string text_;
};

template <typename Number>
std::vector<double> numbersAs(const matvar_t& variable, std::size_t first, std::size_t count) {
  const auto* from = static_cast<const Number*>(variable.data) + first;
  std::vector<double> values(from, from + count);
  std::replace_if(
      values.begin(), values.end(), [](double value) { return !std::isfinite(value); },
      std::numeric_limits<double>::quiet_NaN());
  return values;
}

using Copy = std::vector<double> (*)(const matvar_t&, std::size_t, std::size_t);

/// Function that copies the numbers of a class; empty where the class holds none.
Copy copyOf(const matvar_t& variable) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return numbersAs<double>;
    case MAT_C_SINGLE:
      return numbersAs<float>;
    case MAT_C_INT8:
      return numbersAs<std::int8_t>;
    case MAT_C_UINT8:
      return numbersAs<std::uint8_t>;
    case MAT_C_INT16:
      return numbersAs<std::int16_t>;
    case MAT_C_UINT16:
      return numbersAs<std::uint16_t>;
    case MAT_C_INT32:
      return numbersAs<std::int32_t>;
    case MAT_C_UINT32:
      return numbersAs<std::uint32_t>;
    case MAT_C_INT64:
      return numbersAs<std::int64_t>;
    case MAT_C_UINT64:
      return numbersAs<std::uint64_t>;
    default:
      return nullptr;
  }
}

class MatFile {
 public:
  explicit MatFile(const std::filesystem::path& path) : name_(path.string()) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what fails is said here, and not on the console
    file_.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
    if (file_ == nullptr) {
      throw FileError(name_ + ": cannot be read as a MATLAB file, expected version 4, 5 or 7.3");
    }
    while (const Variable variable{Mat_VarReadNextInfo(file_.get())}) {
      contents_.add(variable->name == nullptr ? "" : variable->name, variable.get());
    }
    if (contents_.names().empty()) {
      throw FileError(name_ +
                      ": holds no variable that can be read, as if empty or cut off; expected vectors");
    }
  }

  std::string contents() const { return contents_.text(); }

  std::vector<double> values(const FileColumn& column) {
    const matvar_t& variable = find(column.name);
    const Copy copy = copyOf(variable);
    if (copy == nullptr || variable.isComplex != 0 || variable.rank != 2 || variable.data == nullptr) {
      fail(column.name, "is " + describe(variable) + ", expected a vector or a matrix of real numbers",
           contents_);
    }
    const std::size_t rows = variable.dims[0], columns = variable.dims[1];
    if (column.index == 0) {
      if (std::min(rows, columns) != 1) {
        fail(column.name,
             fmt::format("is {}, expected a vector, or 'index' from 1 to {} beside 'column'",
                         describe(variable), columns),
             contents_);
      }
      return copy(variable, 0, rows * columns);
    }
    if (column.index > columns) {
      fail(column.name,
           fmt::format("is {}, but 'index' is {}, expected 1 to {}", describe(variable), column.index,
                       columns),
           contents_);
    }
    return copy(variable, (column.index - 1) * rows, rows);
  }

  [[noreturn]] void fail(const std::string& variable, const std::string& problem,
                         const Listing& listing) const {
    throw FileError(
        fmt::format("{}: variable '{}' {}; there is {}", name_, variable, problem, listing.text()));
  }
  const Listing& listing() const noexcept { return contents_; }

 private:
  static std::string describe(const matvar_t& variable) {
    return (variable.isComplex != 0 ? "complex, " : "") + sizeOf(variable);
  }

  /// A variable, or the field of a struct behind the dots of its name.
  matvar_t& find(const std::string& name) {
    const std::size_t dot = name.find('.');
    matvar_t* found = &read(name.substr(0, dot), name);
    for (std::size_t at = dot; at != std::string::npos;) {
      const std::string outer = name.substr(0, at);
      const std::size_t next = name.find('.', at + 1);
      const std::string inner = name.substr(at + 1, next == std::string::npos ? next : next - at - 1);
      if (found->class_type != MAT_C_STRUCT || countOf(*found) != 1) {
        fail(name,
             fmt::format("is not there: '{}' is {}, expected a struct of one element", outer,
                         found->class_type == MAT_C_STRUCT
                             ? fmt::format("an array of {} structs", countOf(*found))
                             : sizeOf(*found)),
             contents_);
      }
      found = &field(*found, name, inner);
      at = next;
    }
    return *found;
  }

  matvar_t& field(matvar_t& outer, const std::string& name, const std::string& inner) const {
    if (matvar_t* found = Mat_VarGetStructFieldByName(&outer, inner.c_str(), 0)) {
      return *found;
    }
    Listing fields;
    char* const* names = Mat_VarGetStructFieldnames(&outer);
    for (unsigned i = 0; i < Mat_VarGetNumberOfFields(&outer); ++i) {
      fields.add(names[i], Mat_VarGetStructFieldByName(&outer, names[i], 0));
    }
    fail(name, "is not there: no field '" + inner + "'" + app::suggestion(inner, fields.names()), fields);
  }

  matvar_t& read(const std::string& top, const std::string& name) {
    const auto& known = contents_.names();
    if (std::find(known.begin(), known.end(), top) == known.end()) {
      fail(name, "is not there" + app::suggestion(top, known), contents_);
    }
    Variable& variable = read_[top];
    if (!variable) {
      variable.reset(Mat_VarRead(file_.get(), top.c_str()));
    }
    if (!variable) {
      fail(name, "cannot be read, as if the file were cut off", contents_);
    }
    return *variable;
  }

  std::string name_;
  std::unique_ptr<mat_t, CloseFile> file_;
  Listing contents_;
  std::map<std::string, Variable> read_;
};

}  // namespace

bool isMatFile(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".mat";
}

std::string matContents(const std::filesystem::path& file) {
  return MatFile(file).contents();
}

NumberTable readMatTable(const std::filesystem::path& file, std::span<const FileColumn> columns) {
  MatFile mat(file);
  NumberTable table{.columns = {columns.begin(), columns.end()}, .values = {}, .line = {}, .warnings = {}};
  for (const FileColumn& column : columns) {
    table.values.push_back(mat.values(column));
    if (table.values.back().size() != table.rows()) {
      mat.fail(column.text(),
               fmt::format("has {} values, but '{}' has {}, expected equally many, samples down the columns",
                           table.values.back().size(), columns.front().text(), table.rows()),
               mat.listing());
    }
  }
  return table;
}

}  // namespace patella::diagnose
