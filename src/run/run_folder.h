// The folder of a run: who may write into it, and what belongs to it.
#pragma once

#include <string>

#include "run/folder_lock.h"

namespace froude::run {

/// A folder that this process alone writes into, for as long as the object lives. Locked as FolderLock says.
class RunFolder {
 public:
  /// The folder for a new run. `wanted` empty: out/SCENE, or out/SCENE-2, … whichever is the first that is not there.
  /// A named folder must be absent or empty. With `force` the files of an earlier run in it are removed first; files
  /// that are not a run's own are never touched, and a folder that holds files but no run is refused. Throws UsageError
  /// for a folder that may not be used, exporting::OutputError for one that cannot be.
  static RunFolder create(const std::string& wanted, const std::string& sceneName, bool force);

  /// The folder of an earlier run. Throws UsageError when it is not one, or when another process is at work in it.
  static RunFolder open(const std::string& folder);

  /// As it was given, without a slash at the end.
  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

  /// Takes back a start that failed: removes a run's own files, and the folder itself if it was made here and is empty.
  void abandon();

 private:
  RunFolder(std::string path, bool made);

  std::string path_;
  bool made_ = false;
  FolderLock lock_;
};

}  // namespace froude::run
