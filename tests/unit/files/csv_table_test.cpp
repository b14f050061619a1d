#include "firmware_app/files/csv_table.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/support/scratch_folder.hpp"

using namespace patella::app;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

CsvTable read(std::string_view text, const CsvOptions& options = {}) {
  return CsvTable::parse(text, "run.csv", options);
}

std::string errorOf(std::string_view text, const CsvOptions& options = {}) {
  return messageOf<FileError>([&] { read(text, options); });
}

}  // namespace

TEST_CASE("columns are found by name, whatever ends the lines") {
  for (const std::string text :
       {"t_s,q1_rad\n0,1.5\n0.001,-2e-3\n", "t_s,q1_rad\r\n0,1.5\r\n0.001,-2e-3\r\n",
        "t_s,q1_rad\n0,1.5\n0.001,-2e-3", "\xEF\xBB\xBFt_s, \"q1_rad\"\n0, +1.5\n\"0.001\",-2e-3\n\r\n\n"}) {
    CAPTURE(text);
    const CsvTable table = read(text);
    REQUIRE(table.rows() == 2);
    CHECK(table.names() == std::vector<std::string>{"t_s", "q1_rad"});
    CHECK(table.column("t_s")[1] == 0.001);
    CHECK(table.column("q1_rad")[0] == 1.5);
    CHECK(table.column("q1_rad")[1] == -2e-3);
    CHECK(table.has("t_s"));
    CHECK_FALSE(table.has("t"));
  }
}

TEST_CASE("without a header columns have numbers, and the first line counts") {
  const CsvTable table = read("0,1.5\n0.001,-2e-3\n", {.header = false});
  CHECK(table.names() == std::vector<std::string>{"1", "2"});
  REQUIRE(table.rows() == 2);
  CHECK(table.column("2")[0] == 1.5);
  CHECK(CsvTable::lineOf(1, false) == 2);
  CHECK(errorOf("", {.header = false}) == "run.csv:1: the file is empty, expected rows of numbers");
  CHECK(errorOf("t_s,q\n0,1\n", {.header = false}) ==
        "run.csv:1: the first line holds no number, expected rows of numbers without a header");
  CHECK(errorOf("0,1\n0\n", {.header = false}) == "run.csv:2: 1 cells, expected 2 as in the first line");
  CHECK(errorOf("0,1\n", {.header = false, .columns = {"3"}}) ==
        "run.csv:1: there is no column '3', expected 1 to 2");
}

TEST_CASE("a space as delimiter is any run of spaces and tabs") {
  const CsvTable table = read("  t_s \t q \r\n 0\t1.5  \n0.001  -2e-3\n  \n", {.delimiter = ' '});
  CHECK(table.names() == std::vector<std::string>{"t_s", "q"});
  REQUIRE(table.rows() == 2);
  CHECK(table.column("q")[1] == -2e-3);
  CHECK(errorOf("t_s q\n0 1 2\n", {.delimiter = ' '}) == "run.csv:2: 3 cells, expected 2 as in the header");
}

TEST_CASE("a last line that lacks cells is left out where that is allowed") {
  const CsvOptions options{.allow_cut_off = true};
  for (const std::string rest : {"2", "2,", "2,-", "2\n\n"}) {
    CAPTURE(rest);
    const CsvTable table = read("t_s,q\n0,1\n1,5\n" + rest, options);
    CHECK(table.rows() == 2);
    CHECK(table.column("q").size() == 2);
    CHECK(table.cutOffLine() == 4);
    CHECK(errorOf("t_s,q\n0,1\n1,5\n" + rest).starts_with("run.csv:4: "));
  }
  CHECK_FALSE(read("t_s,q\n0,1\n1,5\n", options).cutOffLine());
  CHECK(errorOf("t_s,q\n0,1\n1\n2,3\n", options) == "run.csv:3: 1 cells, expected 2 as in the header");
  CHECK(errorOf("t_s,q\n0,1\nx,1\n", options) == "run.csv:3: column 't_s': value 'x', expected a number");
  CHECK(errorOf("t_s,q\n0\n", options) == "run.csv:2: 1 cells, expected 2 as in the header");
}

TEST_CASE("malformed files are refused with file, line, column, value and expectation") {
  CHECK(errorOf("") == "run.csv:1: the file is empty, expected a header of column names");
  CHECK(errorOf("\n\n") == "run.csv:1: the file is empty, expected a header of column names");
  CHECK(errorOf("0,1\n0,2\n") ==
        "run.csv:1: the first line holds numbers, expected a header of column names");
  CHECK(errorOf("t_s,,q\n0,1,2\n") == "run.csv:1: column 2 has no name");
  CHECK(errorOf("t_s,q,q\n0,1,2\n") == "run.csv:1: column 3: name 'q' is repeated");
  CHECK(errorOf("t_s,q\n0,1\n1,abc\n") == "run.csv:3: column 'q': value 'abc', expected a number");
  CHECK(errorOf("t_s,q\n0,1\n1,2.5x\n") == "run.csv:3: column 'q': value '2.5x', expected a number");
  CHECK(errorOf("t_s,q\n0,\n") == "run.csv:2: column 'q': value '', expected a number");
  CHECK(errorOf("t_s,q\n0,1e999\n") == "run.csv:2: column 'q': value '1e999', expected a number");
  CHECK(errorOf("t_s,q\n0,nan\n") == "run.csv:2: column 'q': value 'nan', expected a finite number");
  CHECK(errorOf("t_s,q\n0,1\n1\n") == "run.csv:3: 1 cells, expected 2 as in the header");
  CHECK(errorOf("t_s,q\n0,1\n1,2,3\n") ==
        "run.csv:3: 3 cells, expected 2 as in the header; if its numbers have decimal commas, expected "
        "decimal points");
  CHECK(errorOf("t_s,q\n0,1\n1,2.5,3\n") == "run.csv:3: 3 cells, expected 2 as in the header");
  CHECK(errorOf("t_s,q\n0,1\n\n2,3\n") == "run.csv:3: column 't_s': value '', expected a number");
  CHECK(errorOf("t_s,q\n") == "run.csv:1: 0 rows of numbers, expected at least 1");
  CHECK(errorOf("t_s,q\n0,1\n", {.minimum_rows = 10}) ==
        "run.csv:2: 1 rows of numbers, expected at least 10");
  CHECK(errorOf("t_s,q1_rad\n0,1\n", {.columns = {"q1_Rad"}}) ==
        "run.csv:1: there is no column 'q1_Rad', did you mean 'q1_rad'?");
  const CsvTable table = read("t_s,q1_rad\n0,1\n");
  CHECK(messageOf<FileError>([&] { table.column("q2_rad"); }) ==
        "run.csv:1: there is no column 'q2_rad', did you mean 'q1_rad'?");
}

TEST_CASE("only wanted columns are read, so that others may hold text") {
  const CsvTable table = read("t_s,label,q\n0,walk,1\n1,\"stop\",2\n", {.columns = {"q", "t_s"}});
  CHECK(table.names() == std::vector<std::string>{"t_s", "q"});
  CHECK(table.column("q")[1] == 2.0);
  CHECK(errorOf("t_s,label,q\n0,walk,1\n") == "run.csv:2: column 'label': value 'walk', expected a number");
}

TEST_CASE("missing values and other delimiters are a matter of options") {
  const CsvTable table = read("t_s;q\n0;\n1;nan\n2;inf\n3;4\n", {.delimiter = ';', .allow_missing = true});
  REQUIRE(table.rows() == 4);
  CHECK(std::isnan(table.column("q")[0]));
  CHECK(std::isnan(table.column("q")[1]));
  CHECK(std::isnan(table.column("q")[2]));
  CHECK(table.column("q")[3] == 4.0);
}

TEST_CASE("a file that is read in parts is the same table") {
  const ScratchFolder folder;
  for (const char* end : {"\n", "\r\n"}) {
    // Cells of all lengths, so that parts end anywhere; a line longer than a part; lines without cells.
    std::string text = std::string("\xEF\xBB\xBF") + "a,text,b" + end;
    for (int i = 0; i < 60'000; ++i) {
      text += std::to_string(i) + "," + std::string(i == 30'000 ? 700'000 : i % 7, 'x') + "," +
              std::to_string(0.5 * i) + end;
    }
    text += end;
    writeFile(folder / "long.csv", text);
    const CsvTable table = CsvTable::load(folder / "long.csv", {.columns = {"a", "b"}});
    REQUIRE(table.rows() == 60'000);
    for (std::size_t i = 0; i < table.rows(); ++i) {
      REQUIRE(table.column("a")[i] == static_cast<double>(i));
      REQUIRE(table.column("b")[i] == 0.5 * static_cast<double>(i));
    }
    writeFile(folder / "hole.csv", text + end + "1,x,2" + end);
    CHECK(messageOf<FileError>([&] {
            CsvTable::load(folder / "hole.csv", {.columns = {"a"}});
          }).ends_with("hole.csv:60002: column 'a': value '', expected a number"));
  }
}

TEST_CASE("a column that is taken is no longer in the table") {
  CsvTable table = CsvTable::parse("a,b\n1,2\n3,4\n", "x.csv");
  CHECK(table.take("b") == std::vector<double>{2.0, 4.0});
  CHECK(table.column("b").empty());
  CHECK(table.rows() == 2);
}

TEST_CASE("time that stands still or goes back is found, not rejected") {
  const CsvTable table = read("t_s,back,still\n0,0,0\n1,2,1\n2,1,1\n");
  CHECK_FALSE(table.firstNotIncreasing("t_s").has_value());
  CHECK(table.firstNotIncreasing("back") == 2U);
  CHECK(CsvTable::lineOf(*table.firstNotIncreasing("still")) == 4);
}

TEST_CASE("what is written reads back to the bit") {
  const ScratchFolder folder;
  const double values[] = {0.1, -1.0 / 3.0, 1e-300, std::numeric_limits<double>::quiet_NaN()};
  CsvWriter writer(folder / "run.csv", {"a", "b", "c", "d"});
  writer.row(values);
  CHECK_FALSE(std::filesystem::exists(folder / "run.csv"));
  writer.commit();
  const CsvTable table = CsvTable::load(folder / "run.csv", {.allow_missing = true});
  CHECK(table.column("a")[0] == values[0]);
  CHECK(table.column("b")[0] == values[1]);
  CHECK(table.column("c")[0] == values[2]);
  CHECK(std::isnan(table.column("d")[0]));
}

TEST_CASE("a writer refuses names and rows that would not read back, and leaves nothing behind") {
  const ScratchFolder folder;
  const auto path = folder / "run.csv";
  CHECK(messageOf<std::invalid_argument>([&] {
          CsvWriter(path, {"a", "b,c"});
        }) ==
        path.string() + ": column name 'b,c', expected a unique name without commas, quotes and line ends");
  CHECK_THROWS_AS(CsvWriter(path, {"a", "a"}), std::invalid_argument);
  const auto short_row = [&] {
    CsvWriter writer(path, {"a", "b"});
    writer.row(std::vector<double>{1.0});
  };
  CHECK(messageOf<std::invalid_argument>(short_row) == path.string() + ": 1 values in a row, expected 2");
  CHECK(folder.entries() == 0);
}
