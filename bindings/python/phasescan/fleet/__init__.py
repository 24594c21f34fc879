"""Everything you ever recorded: a map of each log, which logs share a place, a map of those that do.

``python3 -m phasescan.fleet run MANIFEST --out DIR`` on Dask's distributed scheduler: on a laptop, Slurm, Kubernetes. The steps
are plain functions over files: `manifest` says which logs, `record` maps one, `alike` and `ties` say which share a place,
`groups` which belong together, `joint` maps those, `tables` and `report` write what came out; `engine` runs tasks.
"""
