#include "tools/view/subscriptions.hpp"

#include <string>

#include <doctest/doctest.h>

using namespace patella;

TEST_CASE("a client has the channels that it asked for, until it lets them go") {
  view::Subscriptions subscriptions(6);
  CHECK(subscriptions
            .obey(R"({"op":"subscribe","subscriptions":[{"id":7,"channelId":0},{"id":9,"channelId":5}]})")
            .empty());
  CHECK(subscriptions.all() == std::map<std::uint32_t, std::uint16_t>{{7, 0}, {9, 5}});
  CHECK(subscriptions.obey(R"({"op":"unsubscribe","subscriptionIds":[7,8]})").empty());
  CHECK(subscriptions.all() == std::map<std::uint32_t, std::uint16_t>{{9, 5}});
}

TEST_CASE("what is no request is answered in words, and changes nothing") {
  view::Subscriptions subscriptions(6);
  for (const char* message : {"", "[]", R"({"op":1})", R"({"op":"subscribe"})",
                              R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":6}]})",
                              R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":"x"}]})",
                              R"({"op":"advertise","channels":[]})"}) {
    CAPTURE(message);
    CHECK_FALSE(subscriptions.obey(message).empty());
  }
  CHECK(subscriptions.all().empty());
}

TEST_CASE("a number that is no identifier is not taken for another one") {
  view::Subscriptions subscriptions(6);
  for (const char* id : {"-1", "4294967296", "1.5", "1e+30", "true", "null", "\"7\""}) {
    CAPTURE(id);
    const std::string as_id =
        R"({"op":"subscribe","subscriptions":[{"id":)" + std::string(id) + R"(,"channelId":0}]})";
    CHECK(subscriptions.obey(as_id) ==
          "not understood: id " + std::string(id) + ", expected a whole number from 0 to 4294967295");
    const std::string as_channel =
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":)" + std::string(id) + "}]}";
    CHECK_FALSE(subscriptions.obey(as_channel).empty());
  }
  CHECK(subscriptions.all().empty());
  CHECK(
      subscriptions.obey(R"({"op":"subscribe","subscriptions":[{"id":4294967295,"channelId":0}]})").empty());
  CHECK(subscriptions.obey(R"({"op":"unsubscribe","subscriptionIds":[-1]})")
            .starts_with("not understood: id -1"));
  CHECK(subscriptions.all().size() == 1);
}

TEST_CASE("subscriptions do not grow without end") {
  view::Subscriptions subscriptions(6);
  std::string complaint;
  for (std::size_t id = 0; id <= view::Subscriptions::kMost; ++id) {
    complaint = subscriptions.obey(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id) +
                                   R"(,"channelId":1}]})");
  }
  CHECK_FALSE(complaint.empty());
  CHECK(subscriptions.all().size() == view::Subscriptions::kMost);
}
