#include "tools/view/recording.hpp"

#include <cmath>
#include <cstring>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/formats/little_endian.hpp"
#include "firmware_app/formats/tick_message.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/view/log_replay.hpp"

using namespace patella;

namespace {

void writeRun(const test::ScratchFolder& folder) {
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad,state\n0.5,-1,1\n0.75,,2\n2.25,-0.25,4\n");
  app::writeFile(
      folder / "events.log",
      "input=model file=a.toml sha256=0\nt_s=0.75 state=active\nt_s=2.25 state=fault raised=overrun\n");
}

struct Message {
  std::uint32_t channel = 0;
  std::string data;
};

std::vector<Message> messagesIn(const std::string& bytes) {
  std::vector<Message> messages;
  for (std::size_t at = 0; at < bytes.size();) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + at, sizeof length);
    Message message;
    std::memcpy(&message.channel, bytes.data() + at + 5, sizeof message.channel);
    message.data = bytes.substr(at + 17, length - 13);
    messages.push_back(message);
    at += 4 + length;
  }
  return messages;
}

}  // namespace

TEST_CASE("a recorded run is given by the second: its ticks to the last bit, events and timing among them") {
  const test::ScratchFolder folder;
  writeRun(folder);
  double progress = 0.0;
  const view::Recording recording(folder.path(), [&](double fraction) { progress = fraction; });
  CHECK(progress == doctest::Approx(1.0));
  REQUIRE(recording.seconds() == 3);
  const formats::TickDecoder decoder(recording.channels()[0].definition, recording.channels()[0].columns);
  std::vector<std::vector<double>> rows;
  std::vector<std::size_t> kinds(formats::kRunChannels, 0);
  for (std::size_t second = 0; second < recording.seconds(); ++second) {
    for (const Message& message : messagesIn(recording.messagesOf(second))) {
      ++kinds.at(message.channel);
      if (message.channel == static_cast<std::uint32_t>(formats::RunChannel::kTick)) {
        rows.emplace_back();
        decoder.decode(message.data, rows.back());
      }
    }
  }
  REQUIRE(rows.size() == 3);
  CHECK(rows[0] == std::vector<double>{0.5, -1.0, 1.0});
  CHECK(rows[1][0] == 0.75);
  CHECK(std::isnan(rows[1][1]));
  CHECK(rows[2] == std::vector<double>{2.25, -0.25, 4.0});
  CHECK(recording.messagesOf(1).empty());
  CHECK(kinds == std::vector<std::size_t>{3, 0, 2, 2, 0, 0});

  const auto index = nlohmann::json::parse(recording.index());
  CHECK(index["start_s"] == 0.5);
  CHECK(index["end_s"] == 2.25);
  REQUIRE(index["events"].size() == 2);
  CHECK(index["events"][1]["line"] == "t_s=2.25 state=fault raised=overrun");
}

TEST_CASE("a folder without a tick is no recording, and what is no number is named with its line") {
  const test::ScratchFolder folder;
  const auto read = [&] {
    return test::messageOf<std::runtime_error>([&] { view::Recording(folder.path(), [](double) {}); });
  };
  CHECK(read().find("ticks.csv") != std::string::npos);
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad\n");
  CHECK(read().find("has no tick") != std::string::npos);
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad\n0,1\n0.001,x\n");
  CHECK(read().find("ticks.csv:3: column 'q1_rad': value 'x', expected a number") != std::string::npos);
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad\n0,1\n1e9,1\n");
  CHECK(read().find("more than a week") != std::string::npos);
}

TEST_CASE(
    "a log that cannot be played is refused with what the loop said, without its name and in one line") {
  const test::ScratchFolder folder;
  // The loop is looked for beside this program.
  const std::filesystem::path loop =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "patella";
  app::writeFile(loop, "#!/bin/sh\necho 'patella: loop.toml:3: no such key' >&2\nexit 1\n");
  std::filesystem::permissions(loop, std::filesystem::perms::owner_all);
  const std::string message =
      test::messageOf<app::FileError>([&] { const view::LogReplay replay(folder / "x.log", "loop.toml"); });
  std::filesystem::remove(loop);
  CHECK(message == (folder / "x.log").string() + ": cannot be played: loop.toml:3: no such key");
}
