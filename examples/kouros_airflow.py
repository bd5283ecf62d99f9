"""The night as an Airflow DAG (Airflow 3): copy it into the folder of DAGs.

Kouros keeps its own state, and an interrupted night is safe to start again; that is why the task may be retried.
Secrets come from the worker's environment, where KOUROS_DATABASE and the variables that kouros.toml names are set.
"""

from datetime import datetime, timedelta

from airflow.providers.standard.operators.bash import BashOperator
from airflow.sdk import DAG

with DAG(
    dag_id="kouros_nightly",
    description="Seismic risk of the collection, one night",
    schedule="15 2 * * *",
    start_date=datetime(2026, 1, 1),
    catchup=False,
    max_active_runs=1,
) as dag:
    check = BashOperator(
        task_id="check",
        bash_command="/opt/kouros/bin/kouros check",
        cwd="/srv/kouros",
        append_env=True,
    )
    run = BashOperator(
        task_id="run",
        bash_command="/opt/kouros/bin/kouros --quiet --log-json run",
        cwd="/srv/kouros",
        append_env=True,
        retries=1,
        retry_delay=timedelta(minutes=30),
        execution_timeout=timedelta(hours=6),
    )
    check >> run
