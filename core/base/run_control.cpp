#include "core/base/run_control.h"

namespace remesh {

void RunControl::throw_stopped(Reason reason) const {
  if (reason == Reason::kTimeout) throw Error(Code::kTimeout, stage(), "the time allowed for this request is over");
  throw Error(Code::kCancelled, stage(), "the request was cancelled");
}

}  // namespace remesh
