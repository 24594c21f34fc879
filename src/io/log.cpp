#include "phasescan/io/log.hpp"
