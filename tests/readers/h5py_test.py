"""frames.h5 opened by h5py. Usage: h5py_test.py PROGRAM ROOT"""
import csv
import json

from frames import in_temporary_folder, with_module

with_module("h5py")
import h5py  # noqa: E402
import numpy  # noqa: E402


def test(_program, _root, folder):
    summary = json.load(open(f"{folder}/summary.json", encoding="utf-8"))
    with h5py.File(f"{folder}/frames.h5", "r") as file:
        names = sorted(file)
        assert names == [f"frame_{k:05d}" for k in range(summary["frames"])] and len(names) == 3, names
        segments = {file.get(name, getlink=True).filename for name in names}
        assert segments == {"frames/0000.h5", "frames/0001.h5"}, segments
        for index, name in enumerate(names):
            frame = file[name]
            assert frame.attrs["index"] == index
            count = len(frame["position"])
            for column, shape in {"position": (count, 2), "velocity": (count, 2), "pressure": (count,), "density": (count,),
                                  "species": (count,), "id": (count,)}.items():
                assert frame[column].shape == shape and numpy.isfinite(frame[column][:]).all(), (name, column)
            species = frame["species"][:]
            assert set(species) == {0, 2}
            triangles = frame["triangles"][:]
            assert triangles.shape[1] == 3 and (species[triangles] == 2).all()
            for kind in (0, 2):
                ids = frame["id"][:][species == kind]
                assert len(numpy.unique(ids)) == len(ids)
        last = file[names[-1]]
        assert len(last["position"]) == summary["particles"]
        # The kinetic energy of the last frame is that of the gauge, between its rows.
        rows = list(csv.DictReader(open(f"{folder}/gauges.csv", encoding="utf-8")))
        times = [float(row["t"]) for row in rows if row["energy.kinetic"]]
        energies = [float(row["energy.kinetic"]) for row in rows if row["energy.kinetic"]]
        water = last["species"][:] == 0
        speed2 = (last["velocity"][:][water].astype(float) ** 2).sum(axis=1)
        kinetic = 0.5 * 1000.0 * summary["spacing"] ** 2 * speed2.sum()
        assert 0.0 < kinetic < 1.05 * numpy.interp(last.attrs["time"], times, energies), kinetic
    print(f"h5py {h5py.__version__}: {len(names)} frames read")


in_temporary_folder(test)
