#include "live_serve.hpp"

#include <tuple>
#include <utility>

#include "phasescan/io/error.hpp"
#include "serve/page.hpp"

namespace phasescan::app {

LiveShow::LiveShow(const SlamOptions& options, const serve::StatusBoard& status_board, serve::LiveControl& live_control)
    : board(status_board),
      control(live_control),
      viewer(std::make_shared<serve::Viewer>(options, live_control, [this] { return status(); })),
      foxglove(std::make_shared<foxglove::Endpoint>([this](const Pose2& T_map_base, serve::CommandDone done) {
        control.set_pose(T_map_base, std::move(done));
      })) {}

serve::Router live_router(const LiveShow& show) {
  serve::Router router;
  router.add_page("/", [](const serve::Target&) { return serve::page_answer(); });
  router.add_page("/api/status", [&show](const serve::Target&) {
    return serve::Answer{200, "application/json", show.status(), {}};
  });
  router.add_page("/api/map.png", [&show](const serve::Target&) {
    std::string png = show.viewer->png();
    if (png.empty()) return serve::Answer{503, "text/plain; charset=utf-8", "the map is too large for a picture\n", {}};
    return serve::Answer{200, "image/png", std::move(png), {}};
  });
  router.add_endpoint("/ws", show.viewer);
  router.add_endpoint("/foxglove", show.foxglove);
  // Another protocol: router.add_endpoint("/path", endpoint) here, and its sink into the list of apps/cmd_live.cpp.
  return router;
}

std::unique_ptr<serve::Server> serve_run(const std::string& where, const serve::Router& router,
                                         const std::function<void(const std::string&)>& tell) {
  constexpr int kPorts = 10;  // that are tried
  if (where == "off") return nullptr;
  serve::ServeOptions options;
  if (!where.empty()) std::tie(options.address, options.port) = serve::parse_address(where);
  std::unique_ptr<serve::Server> server;
  for (int tried = 1; !server; ++tried, ++options.port) {
    try {
      server = std::make_unique<serve::Server>(options, router);
    } catch (const SystemError& error) {
      if (!where.empty()) throw;
      if (tried < kPorts && serve::has_server()) continue;
      tell(std::string(error.what()) + "; nothing is shown");
      return nullptr;
    }
  }
  tell("open " + server->url());
  return server;
}

}  // namespace phasescan::app
