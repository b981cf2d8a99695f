"""frames.xdmf opened by ParaView itself. Usage: paraview_test.py PROGRAM ROOT"""
import re

from frames import in_temporary_folder, with_module

with_module("paraview")
from paraview import simple  # noqa: E402
from paraview import servermanager  # noqa: E402


def blocks(data):
    """All data sets in a tree of blocks."""
    if data is None:
        return []
    if not data.IsA("vtkCompositeDataSet"):
        return [data]
    iterator, found = data.NewIterator(), []
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        found.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return found


def test(_program, _root, folder):
    text = open(f"{folder}/frames.xdmf", encoding="utf-8").read()
    reader = simple.OpenDataFile(f"{folder}/frames.xdmf")
    reader.UpdatePipelineInformation()
    steps = list(reader.TimestepValues)
    times = sorted({float(t) for t in re.findall(r'<Time Value="([^"]+)"', text)})
    assert steps == times and len(steps) == 3, (steps, times)
    counts = [int(n) for n in re.findall(r'TopologyType="Polyvertex" NumberOfElements="(\d+)"', text)]
    triangles = [int(n) for n in re.findall(r'TopologyType="Triangle" NumberOfElements="(\d+)"', text)]
    for step, time in enumerate(steps):
        reader.UpdatePipeline(time)
        found = blocks(servermanager.Fetch(reader))
        vertices = [b for b in found if b.GetPointData().HasArray("velocity")]
        surfaces = [b for b in found if b.GetCellData().HasArray("strain")]
        # A cell for each point: without cells ParaView has the points, and draws none.
        assert [(b.GetNumberOfPoints(), b.GetNumberOfCells()) for b in vertices] == [(counts[step],) * 2], (step, counts)
        assert sum(b.GetNumberOfCells() for b in surfaces) == triangles[step]
        data = vertices[0].GetPointData()
        for name, components in {"velocity": 3, "pressure": 1, "density": 1, "species": 1, "id": 1}.items():
            array = data.GetArray(name)
            assert array is not None and array.GetNumberOfComponents() in (components, 2), name
        assert step == 0 or data.GetArray("density").GetRange(0)[0] > 0.0
        assert data.GetArray("species").GetRange(0) == (0.0, 2.0)
        bounds = vertices[0].GetBounds()
        assert bounds[0] >= 0.0 and bounds[1] <= 3.0 and bounds[2] >= 0.0 and bounds[3] <= 2.0, bounds
    assert data.GetArray("velocity").GetRange(-1)[1] > 0.1
    print(f"ParaView {simple.GetParaViewVersion()}: {len(steps)} times, {counts[-1]} points, {triangles[-1]} triangles")


in_temporary_folder(test)
