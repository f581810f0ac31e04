# The desktop's sources; included by app/CMakeLists.txt, which links palpate::desktop to the program.
palpate_library(desktop
  SOURCES
    desktop.cpp
    desktop_actions.cpp
    desktop_case.cpp
    desktop_child.cpp
    desktop_exchange.cpp
    desktop_import.cpp
    desktop_job.cpp
    desktop_loop.cpp
    desktop_recent.cpp
    desktop_review.cpp
    desktop_scene.cpp
    desktop_segment.cpp
    desktop_signals.cpp
    desktop_simulation.cpp
    desktop_trade.cpp
    frame_report.cpp
    label_worker.cpp
    series_rows.cpp
  PUBLIC palpate::ui palpate::imaging palpate::imaging_exchange palpate::session palpate::devices
    palpate::wiring palpate::trade
  PRIVATE nlohmann_json::nlohmann_json)
target_compile_definitions(palpate_desktop PRIVATE PALPATE_VERSION="${PROJECT_VERSION}")
