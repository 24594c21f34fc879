#include "serve/page.hpp"

#include "serve/access.hpp"

namespace phasescan::serve {

Answer page_answer() {
  const std::string nonce = random_token();
  Answer answer{200, "text/html; charset=utf-8", kPageText, {}};
  constexpr std::string_view kPlace = "NONCE_HERE";
  for (std::size_t at = answer.body.find(kPlace); at != std::string::npos; at = answer.body.find(kPlace, at))
    answer.body.replace(at, kPlace.size(), nonce);
  // Inline style attributes are set by the page's script through the DOM, which needs no permission.
  answer.headers.emplace_back(
      "Content-Security-Policy",
      "default-src 'none'; script-src 'nonce-" + nonce + "'; style-src 'nonce-" + nonce +
          "'; img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
          "frame-ancestors 'none'");
  return answer;
}

}  // namespace phasescan::serve
