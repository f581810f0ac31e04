# The desktop's sources; included by app/CMakeLists.txt, which links palpate::desktop to the program.
add_library(palpate_desktop STATIC
  desktop.cpp)
add_library(palpate::desktop ALIAS palpate_desktop)
target_include_directories(palpate_desktop PUBLIC ${PROJECT_SOURCE_DIR})
target_link_libraries(palpate_desktop
  PUBLIC palpate::ui palpate::imaging palpate::session palpate::devices
  PRIVATE palpate::warnings)
