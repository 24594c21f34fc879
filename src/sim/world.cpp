#include "phasescan/io/pairs.hpp"
