#include "tools/view/page.hpp"

#include <doctest/doctest.h>

#include "core/safety/fault.hpp"

using namespace patella;

TEST_CASE("the page tells of every fault that there is, with its cause and the way out") {
  const std::string page = view::pageFor(view::PageKind::kLive, "n");
  for (int i = 0; i < safety::kFaultCount; ++i) {
    const std::string name(safety::faultName(static_cast<safety::Fault>(i)));
    CAPTURE(name);
    CHECK(page.find("\n  " + name + ": [\"") != std::string::npos);
  }
}

TEST_CASE("styles and scripts carry the nonce of their answer, which differs from answer to answer") {
  const std::string nonce = view::freshNonce();
  CHECK(nonce.size() == 32);
  CHECK(view::freshNonce() != nonce);
  const std::string page = view::pageFor(view::PageKind::kRecording, nonce);
  CHECK(page.find("<style nonce=\"" + nonce + "\">") != std::string::npos);
  CHECK(page.find("<script type=\"module\" nonce=\"" + nonce + "\">") != std::string::npos);
  CHECK(page.find("data-kind=\"recording\"") != std::string::npos);
  CHECK(page.find("@NONCE@") == std::string::npos);
  CHECK(view::contentPolicy(nonce).find("script-src 'nonce-" + nonce + "'") != std::string::npos);
}
