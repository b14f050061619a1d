// Variables of MATLAB files, which the tests write themselves.
#include <array>
#include <vector>

#include <doctest/doctest.h>
#include <matio.h>

#include "tests/unit/recordings/mapped.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

constexpr std::size_t kRows = 300;

matvar_t* matrix(const char* name, std::size_t rows, std::size_t columns, std::vector<double> values) {
  std::array<std::size_t, 2> size{rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), 0);
}

/// Column of `value` over the numbers of the rows.
template <typename Value>
std::vector<double> column(Value&& value, std::size_t rows = kRows) {
  std::vector<double> values;
  for (std::size_t i = 0; i < rows; ++i) {
    values.push_back(value(static_cast<double>(i)));
  }
  return values;
}

class File {
 public:
  explicit File(mat_ft version = MAT_FT_MAT5)
      : version_(version), file_(Mat_CreateVer((folder_ / "run.mat").c_str(), nullptr, version)) {
    REQUIRE(file_ != nullptr);
  }
  ~File() { close(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void add(matvar_t* variable) {
    REQUIRE(variable != nullptr);
    CHECK(Mat_VarWrite(file_, variable,
                       version_ == MAT_FT_MAT5 ? MAT_COMPRESSION_ZLIB : MAT_COMPRESSION_NONE) == 0);
    Mat_VarFree(variable);
  }
  /// t, counts as int16, data of three columns, log.arm.q and others.
  void addAll() {
    add(matrix("t", kRows, 1, column([](double i) { return 0.002 * i; })));
    std::vector<std::int16_t> counts;
    for (std::size_t i = 0; i < kRows; ++i) {
      counts.push_back(static_cast<std::int16_t>(i));
    }
    std::array<std::size_t, 2> size{1, kRows};
    add(Mat_VarCreate("counts", MAT_C_INT16, MAT_T_INT16, 2, size.data(), counts.data(), 0));
    add(matrix("data", kRows, 3, column([](double i) { return i; }, 3 * kRows)));
    const std::array<const char*, 1> outer{"arm"}, inner{"q"};
    std::array<std::size_t, 2> one{1, 1};
    matvar_t* log = Mat_VarCreateStruct("log", 2, one.data(), const_cast<const char**>(outer.data()), 1);
    matvar_t* arm = Mat_VarCreateStruct("arm", 2, one.data(), const_cast<const char**>(inner.data()), 1);
    Mat_VarSetStructFieldByName(arm, "q", 0, matrix("q", kRows, 1, column([](double i) { return 0.1 * i; })));
    Mat_VarSetStructFieldByName(log, "arm", 0, arm);
    add(log);
    add(matrix("short", 10, 1, column([](double i) { return i; }, 10)));
    add(Mat_VarCreate("note", MAT_C_CHAR, MAT_T_UTF8, 2, one.data(), const_cast<char*>("x"), 0));
  }
  Recording load(const std::string& position, const std::string& recording = "time_column = 't'\n") {
    close();
    app::writeFile(folder_ / "map.toml",
                   "[recording]\ntorque = 'held'\n" + recording +
                       "[[joint]]\ntorque = { column = 'data', index = 2 }\nposition = { " + position +
                       " }\n");
    return loadRecording(folder_ / "run.mat", {.joints = 1, .columns = folder_ / "map.toml"});
  }
  std::string refusal(const std::string& position, const std::string& recording = "time_column = 't'\n") {
    return fromName(test::messageOf<app::FileError>([&] { load(position, recording); }));
  }
  /// Refusal of the first share of the file's bytes; a column near its end is asked for.
  std::string refusalOfPart(double share) {
    close();
    const std::string bytes = app::readFile(folder_ / "run.mat");
    std::filesystem::create_directories(folder_ / "part");
    app::writeFile(folder_ / "part/run.mat",
                   bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
    app::writeFile(folder_ / "map.toml",
                   "[recording]\ntorque = 'held'\nrate_Hz = 10\n[[joint]]\ntorque = { constant = 0 }\n"
                   "position = { column = 'short' }\n");
    return fromName(test::messageOf<app::FileError>(
        [&] { loadRecording(folder_ / "part/run.mat", {.joints = 1, .columns = folder_ / "map.toml"}); }));
  }
  std::string refusalWithoutMap() {
    close();
    return fromName(
        test::messageOf<app::FileError>([&] { loadRecording(folder_ / "run.mat", {.joints = 1}); }));
  }

 private:
  static std::string fromName(const std::string& message) {
    const auto at = message.find("run.mat");
    return at == std::string::npos ? message : message.substr(at);
  }
  void close() {
    if (file_ != nullptr) {
      Mat_Close(file_);
      file_ = nullptr;
    }
  }

  test::ScratchFolder folder_;
  mat_ft version_;
  mat_t* file_;
};

constexpr const char* kHeld =
    "; there is t (300x1), counts (1x300), data (300x3), log (struct), short (10x1), note (char)";

}  // namespace

TEST_CASE("vectors, columns of matrices and fields of structs, in both versions") {
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    CAPTURE(static_cast<int>(version));
    File file(version);
    file.addAll();
    const Recording recording = file.load("column = 'log.arm.q', unit = 'deg', offset = 1");
    REQUIRE(recording.rows() == kRows);
    CHECK(recording.rate_Hz == 500.0);
    CHECK(recording.position_rad[0][123] == doctest::Approx(13.3 * 3.14159265358979 / 180.0));
    CHECK(recording.torque_Nm[0][123] == 423.0);
    CHECK(file.load("column = 'counts', scale = 0.5").position_rad[0][123] == doctest::Approx(61.5));
    CHECK(file.load("column = 'data', index = 3", "time_column = 'data'\ntime_index = 1\ntime_unit = 'ms'\n")
              .rate_Hz == 1000.0);
  }
}

TEST_CASE("what a MATLAB file does not hold is refused with what it holds") {
  File newer(MAT_FT_MAT73);
  newer.addAll();
  const std::string message = newer.refusal("column = 'x'");
  CHECK(message.starts_with("run.mat: variable 'x' is not there"));
  CHECK(message.find("log (struct)") != std::string::npos);
  CHECK(message.find("#refs#") == std::string::npos);
  File file;
  file.addAll();
  CHECK(file.refusal("column = 'dat'") ==
        std::string("run.mat: variable 'dat' is not there, did you mean 'data'?") + kHeld);
  CHECK(file.refusal("column = 'data'") ==
        std::string(
            "run.mat: variable 'data' is 300x3, expected a vector, or 'index' from 1 to 3 beside 'column'") +
            kHeld);
  CHECK(file.refusal("column = 'data', index = 4") ==
        std::string("run.mat: variable 'data' is 300x3, but 'index' is 4, expected 1 to 3") + kHeld);
  CHECK(file.refusal("column = 'log'") ==
        std::string("run.mat: variable 'log' is struct, expected a vector or a matrix of real numbers") +
            kHeld);
  CHECK(file.refusal("column = 'note'") ==
        std::string("run.mat: variable 'note' is char, expected a vector or a matrix of real numbers") +
            kHeld);
  CHECK(file.refusal("column = 'log.arm.w'") ==
        "run.mat: variable 'log.arm.w' is not there: no field 'w', did you mean 'q'?; there is q (300x1)");
  CHECK(file.refusal("column = 't.q'") ==
        std::string("run.mat: variable 't.q' is not there: 't' is 300x1, expected a struct of one element") +
            kHeld);
  CHECK(file.refusal("column = 'short'") ==
        std::string(
            "run.mat: variable 'short' has 10 values, but 't' has 300, expected equally many, samples down "
            "the columns") +
            kHeld);
  CHECK(file.refusalWithoutMap() ==
        "run.mat: is a MATLAB file, expected a map of its variables (--columns); it holds t (300x1), counts "
        "(1x300), data (300x3), log (struct), short (10x1), note (char)");
}

TEST_CASE("of many variables the first twenty are listed") {
  File file;
  for (int i = 0; i < 23; ++i) {
    file.add(matrix(fmt::format("v{}", i).c_str(), 1, 1, {0.0}));
  }
  const std::string refusal = file.refusal("column = 'x'");
  CHECK(refusal.find("v19 (1x1) and 3 more") != std::string::npos);
  CHECK(refusal.find("v20") == std::string::npos);
}

TEST_CASE("what is no MATLAB file, or only a part of one, is refused") {
  const test::ScratchFolder folder;
  app::writeFile(folder / "run.mat", "t_s,q1_rad,tau1_Nm\n0,0,0\n");
  const std::string message =
      test::messageOf<app::FileError>([&] { loadRecording(folder / "run.mat", {.joints = 1}); });
  CHECK(message.ends_with("run.mat: cannot be read as a MATLAB file, expected version 4, 5 or 7.3"));
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    CAPTURE(static_cast<int>(version));
    File whole(version);
    whole.addAll();
    for (const double share : {0.9, 0.5, 0.2}) {
      CAPTURE(share);
      const std::string refusal = whole.refusalOfPart(share);
      CHECK(refusal.starts_with(version == MAT_FT_MAT5
                                    ? "run.mat: variable 'short' is not there; there is t (300x1)"
                                    : "run.mat: holds no variable that can be read"));
    }
  }
}

TEST_CASE("a value that is not finite is a lost sample") {
  File file;
  file.add(matrix("t", kRows, 1, column([](double i) { return 0.002 * i; })));
  file.add(matrix("data", kRows, 2, column([](double i) { return i; }, 2 * kRows)));
  file.add(matrix("q", kRows, 1, column([](double i) { return i == 100.0 ? 1.0 / 0.0 : 0.01 * i; })));
  const Recording recording = file.load("column = 'q'");
  CHECK(recording.rows() == kRows);
  CHECK(recording.position_rad[0][100] == doctest::Approx(1.0).epsilon(1e-6));
  CHECK(test::warnsOf(recording, "1 rows without a value were taken as lost, the first at"));
}
