#include "phasescan/core/pose2.hpp"
