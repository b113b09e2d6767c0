"""The application: composition of runs, evaluation, viewers, reports, submissions, bridges, and all commands."""
