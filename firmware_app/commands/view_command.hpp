// `patella view`: a program of its own, so that nothing of it is part of the loop's process.
#pragma once

namespace patella::app {

/// Becomes patella-view, the one beside this program or else the one that the shell would find, with the
/// arguments behind "view". Returns the exit status where there is none.
int becomeViewer(char** arguments);

}  // namespace patella::app
