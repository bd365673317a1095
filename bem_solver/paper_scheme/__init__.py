"""The paper's own discretisation: uniform annuli, fixed time steps, backward Euler."""
