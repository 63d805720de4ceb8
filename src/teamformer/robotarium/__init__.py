"""Teams of real robots: Robotarium's rules, a safe controller, and missions under a policy."""
