# The benchmark scenes and the loop that times them: for `carom bench`, bench_scenes and the determinism check.
set(folder ${CMAKE_CURRENT_LIST_DIR})
add_library(carom_benchmark_scenes STATIC EXCLUDE_FROM_ALL ${folder}/recipe.cpp ${folder}/suites.cpp
  ${folder}/scenes_box3d.cpp ${folder}/scenes_box2d.cpp ${folder}/scenes_jolt.cpp ${folder}/rain2.cpp ${folder}/rain3.cpp
  ${folder}/ragdolls_jolt.cpp ${folder}/characters_jolt.cpp
  ${folder}/measure.cpp)
target_link_libraries(carom_benchmark_scenes PUBLIC carom carom_flags)
set_target_properties(carom_benchmark_scenes PROPERTIES UNITY_BUILD ${CAROM_UNITY} UNITY_BUILD_BATCH_SIZE ${CAROM_UNITY_BATCH})
