"""The figures of the report, one a file: functions from values to a matplotlib ``Figure`` and to its caption."""
