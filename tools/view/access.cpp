#include "tools/view/access.hpp"

#include <algorithm>
#include <stdexcept>

#include "drivers/files/regular_file.hpp"

namespace patella::view {
namespace {

constexpr std::size_t kShortestToken = 16;
/// One line; a file of another kind was named by mistake.
constexpr files::FileKind kTokenFile{"a token", 4096};

std::string tokenOf(std::string_view target) {
  constexpr std::string_view kKey = "token=";
  const std::size_t question = target.find('?');
  std::string_view query = question == std::string_view::npos ? "" : target.substr(question + 1);
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    if (query.starts_with(kKey)) {
      return std::string(query.substr(kKey.size(), end - kKey.size()));
    }
    query.remove_prefix(std::min(end + 1, query.size()));
  }
  return {};
}

// Takes as long for a wrong token as for the right one.
bool sameToken(std::string_view given, std::string_view wanted) {
  unsigned difference = given.size() == wanted.size() ? 0 : 1;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const char character = i < given.size() ? given[i] : '\0';
    difference |=
        static_cast<unsigned>(static_cast<unsigned char>(character) ^ static_cast<unsigned char>(wanted[i]));
  }
  return difference == 0;
}

bool holds(const std::vector<std::string>& list, const std::string& item) {
  return std::find(list.begin(), list.end(), item) != list.end();
}

}  // namespace

std::string refusal(const Access& access, const Visitor& visitor) {
  if (!access.token.empty() && !sameToken(tokenOf(visitor.target), access.token)) {
    return "the token is wrong or missing, expected ?token=... behind the address";
  }
  // With a token, the server may have names that it does not know.
  if (access.token.empty() && !holds(access.hosts, visitor.host)) {
    return "host '" + visitor.host + "' is no name of this server";
  }
  const bool own = visitor.origin.empty() || visitor.origin == "http://" + visitor.host;
  if (!own && !holds(access.origins, visitor.origin)) {
    return "pages of '" + visitor.origin + "' may not connect, see --allow-origin";
  }
  return {};
}

std::string readToken(const std::filesystem::path& file) {
  constexpr const char* kSpace = " \t\r\n\v\f";
  const std::string text = files::readWhole(file, kTokenFile);
  const std::size_t start = std::min(text.find_first_not_of(kSpace), text.size());
  const std::string token = text.substr(start, text.find_first_of(kSpace, start) - start);
  if (token.size() < kShortestToken) {
    throw std::runtime_error(file.string() + ": a token of " + std::to_string(token.size()) +
                             " characters, expected at least " + std::to_string(kShortestToken));
  }
  return token;
}

std::vector<std::string> hostsOf(const std::string& address, std::uint16_t port) {
  const std::string suffix = ":" + std::to_string(port);
  const std::string own = address.find(':') == std::string::npos ? address : "[" + address + "]";
  constexpr std::uint16_t kHttpPort = 80;
  std::vector<std::string> hosts;
  for (const std::string& name :
       {own, std::string("localhost"), std::string("127.0.0.1"), std::string("[::1]")}) {
    hosts.push_back(name + suffix);
    if (port == kHttpPort) {
      hosts.push_back(name);  // browsers leave the scheme's own port out
    }
  }
  return hosts;
}

}  // namespace patella::view
