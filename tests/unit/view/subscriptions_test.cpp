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
