#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <string>

namespace softfinger {

using MujocoModel = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

/// The model of an MJCF text, by way of MuJoCo's files in memory: it has no reader of strings.
/// @param failure  MuJoCo's reason, where there is no model
/// @returns null where MuJoCo refuses the text
inline MujocoModel load_mujoco(const std::string& xml, std::string& failure) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "scene.xml", int(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  char error[1000] = "";
  MujocoModel model(mj_loadXML("scene.xml", files.get(), error, sizeof error), mj_deleteModel);
  mj_deleteVFS(files.get());
  if (!model) failure = error;
  return model;
}

}  // namespace softfinger
