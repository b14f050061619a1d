// The page for browsers: one file, joined at build from tools/view/page.
#pragma once

#include <string>

namespace patella::view {

enum class PageKind { kLive, kRecording };

/// `nonce` marks its styles and its scripts as the page's own, see contentPolicy().
std::string pageFor(PageKind kind, const std::string& nonce);

/// What the page may load, for the header Content-Security-Policy: what carries the nonce, and data of this
/// server.
std::string contentPolicy(const std::string& nonce);

/// A word that nobody can guess.
std::string freshNonce();

}  // namespace patella::view
