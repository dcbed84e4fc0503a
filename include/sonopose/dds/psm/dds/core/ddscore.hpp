#pragma once
/// \file
/// dds::core. Left out: External, optional, WeakReference, BuiltinTopicTypes, to print an InstanceHandle.

#include "Entity.hpp"
#include "Exception.hpp"
#include "Time.hpp"
#include "cond/WaitSet.hpp"
#include "policy/CorePolicy.hpp"
#include "status/Status.hpp"
#include "types.hpp"
