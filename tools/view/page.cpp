#include "tools/view/page.hpp"

#include <array>
#include <cstdio>
#include <random>
#include <string_view>
#include <utility>

namespace patella::view {
namespace {

constexpr auto kParts = std::to_array<std::string_view>({
#include "tools/view/page.inc"
});

}  // namespace

std::string pageFor(PageKind kind, const std::string& nonce) {
  const std::array<std::pair<std::string_view, std::string_view>, 2> marks = {
      {{"@NONCE@", nonce}, {"@KIND@", kind == PageKind::kLive ? "live" : "recording"}}};
  std::string page;
  for (const std::string_view part : kParts) {
    page += part;
  }
  for (const auto& [mark, value] : marks) {
    for (std::size_t at = page.find(mark); at != std::string::npos; at = page.find(mark, at)) {
      page.replace(at, mark.size(), value);
    }
  }
  return page;
}

std::string contentPolicy(const std::string& nonce) {
  const std::string own = "'nonce-" + nonce + "'";
  return "default-src 'none'; script-src " + own + "; style-src " + own +
         "; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

std::string freshNonce() {
  std::random_device device;
  std::string nonce;
  for (int word = 0; word < 4; ++word) {
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%08x", device());
    nonce += digits.data();
  }
  return nonce;
}

}  // namespace patella::view
