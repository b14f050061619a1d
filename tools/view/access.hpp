// Who may connect. The server only reads, but what it shows is about a patient.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace patella::view {

struct Access {
  std::string token;  ///< empty: none is asked for
  std::vector<std::string>
      hosts;  ///< names and addresses that a browser may call the server by, with the port
  std::vector<std::string> origins;  ///< of pages elsewhere that may connect
};

/// What a request says of itself; empty where it does not.
struct Visitor {
  std::string host;
  std::string origin;
  std::string target;  ///< "/?token=..."
};

/// Empty where the visitor may come in, else why not. A page of another site is refused by its origin, and a
/// name that was made to lead here by its host.
std::string refusal(const Access& access, const Visitor& visitor);

/// The first word of a file. Throws std::runtime_error with the path where it cannot be read, and why, or is
/// too short to be a secret.
std::string readToken(const std::filesystem::path& file);

/// Hosts by which a server that listens there may be called. Those of port 80 stand without it as well.
std::vector<std::string> hostsOf(const std::string& address, std::uint16_t port);

}  // namespace patella::view
