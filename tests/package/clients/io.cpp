#include <phasescan/io/error.hpp>
#include <phasescan/io/log.hpp>

int main() {
  try {
    phasescan::open_log("/no/such/log");
  } catch (const phasescan::InputError&) {
    return 0;
  } catch (const phasescan::SystemError&) {
    return 0;
  }
  return 1;
}
