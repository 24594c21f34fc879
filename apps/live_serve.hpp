// The server of `live`: the page, the status, and where protocols are attached.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "foxglove/endpoint.hpp"
#include "serve/live_control.hpp"
#include "serve/server.hpp"
#include "serve/status_board.hpp"
#include "serve/viewer.hpp"

namespace phasescan::app {

/// What is shown of a run.
struct LiveShow {
  /// @param options  of SLAM; the cells of a known map. What is given must outlive it.
  LiveShow(const SlamOptions& options, const serve::StatusBoard& status_board, serve::LiveControl& live_control);
  /// The run in numbers, as `/api/status` has them.
  std::string status() const { return to_json(board.status(), control.state()); }

  const serve::StatusBoard& board;
  serve::LiveControl& control;
  std::shared_ptr<serve::Viewer> viewer;
  std::shared_ptr<foxglove::Endpoint> foxglove;
};

/// All paths of the server. `show` must outlive it.
serve::Router live_router(const LiveShow& show);

/// Begins to serve at "ADDR:PORT" and tells the address to open. @param where  empty: the usual place, or the next port
/// that is free; "off": nowhere. @throws as serve::Server, where a place was named
std::unique_ptr<serve::Server> serve_run(const std::string& where, const serve::Router& router,
                                         const std::function<void(const std::string&)>& tell);

}  // namespace phasescan::app
