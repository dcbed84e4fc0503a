#include "process/background.hpp"

#include <sched.h>

namespace sonopose::process {

void give_way() {
  constexpr int calling_thread = 0;
  if (::sched_getscheduler(calling_thread) != SCHED_OTHER) return;
  const sched_param none{};
  ::sched_setscheduler(calling_thread, SCHED_BATCH, &none);
}

}  // namespace sonopose::process
