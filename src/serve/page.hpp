/// The page: one HTML text with its style and its scripts (src/serve/page), nothing from elsewhere.
#pragma once

#include "serve/router.hpp"

namespace phasescan::serve {

/// Made by the build; NONCE_HERE stands where each answer has a nonce of its own.
extern const char* const kPageText;

/// With headers that let the page run its own scripts alone and talk to this server alone.
Answer page_answer();

}  // namespace phasescan::serve
